//! Tests handlers of timeouts: `on timeout { release PHASE  retry N }`.
use stochc_compiler::diagnostic::Code;
use stochc_ir::emit::table_text;

use super::checked;

/// Returns a program with this head, body and handler of its second phase.
fn program(head: &str, body: &str, handler: &str) -> String {
    format!(
        "assembly a(n = 2) {{
            seed plate 1 x 1 {{ M at (0, 0) }}
            phase foot {{ M.up -> A }}
            phase top {head} {{ {body} }} {handler}
        }}"
    )
}

/// Returns the codes of the errors of a program.
fn errors(head: &str, body: &str, handler: &str) -> Vec<Code> {
    let checked = checked(&program(head, body, handler));
    let errors = checked.diagnostics.iter().filter(|it| it.is_error());
    errors.map(|it| it.code).collect()
}

const LIMIT: &str = "timeout 9000 ticks";
const BODY: &str = "A.up -> B.up -> C  A.east -> D";

#[test]
fn a_phase_with_a_timeout_can_be_retried() {
    for handler in [
        "",
        "on timeout { release top retry 3 }",
        "on timeout { release top retry n + 1 }",
        "on timeout { release top wait 20 s retry 1 }",
        "on timeout { release top wait 10 ticks retry 1000 }",
    ] {
        assert_eq!(errors(LIMIT, BODY, handler), [], "{handler}");
    }
}

#[test]
fn a_handler_releases_its_phase_and_begins_it_again() {
    for handler in [
        "on timeout { }",
        "on timeout { retry 3 }",
        "on timeout { release top }",
        "on timeout { retry 3 release top }",
        "on timeout { release top retry 3 wait 20 s }",
        "on timeout { release foot retry 3 }",
        "on timeout { release A retry 3 }",
        "on timeout { release top, top retry 3 }",
        "on timeout { release top after A retry 3 }",
    ] {
        assert_eq!(
            errors(LIMIT, BODY, handler),
            [Code::InvalidHandler],
            "{handler}"
        );
    }
}

#[test]
fn a_handler_needs_a_timeout() {
    let handler = "on timeout { release top retry 3 }";
    assert_eq!(errors("", BODY, handler), [Code::InvalidHandler]);
}

#[test]
fn a_phase_with_releases_cannot_be_retried() {
    let handler = "on timeout { release top retry 3 }";
    for body in [
        "release A",
        "A.up -> B  release B",
        "M.up -> A after release A release A",
    ] {
        assert_eq!(
            errors(LIMIT, body, handler),
            [Code::InvalidHandler],
            "{body}"
        );
    }
}

#[test]
fn numbers_and_times_of_a_handler_are_checked() {
    for (handler, code) in [
        ("on timeout { release top retry 0 }", Code::WrongValue),
        ("on timeout { release top retry 1001 }", Code::WrongValue),
        ("on timeout { release top retry 1 / 0 }", Code::Arithmetic),
        (
            "on timeout { release top wait 3 retry 2 }",
            Code::WrongDimension,
        ),
        (
            "on timeout { release top wait 3 kg retry 2 }",
            Code::WrongDimension,
        ),
    ] {
        assert_eq!(errors(LIMIT, BODY, handler), [code], "{handler}");
    }
}

#[test]
fn statements_of_handlers_have_their_place() {
    for (body, handler) in [
        ("A.up -> B retry 3", ""),
        (BODY, "on timeout { release top A.up -> X retry 3 }"),
        (BODY, "let x = 1 on timeout { release top retry 3 }"),
    ] {
        assert!(
            errors(LIMIT, body, handler).contains(&Code::Misplaced),
            "{handler}"
        );
    }
}

#[test]
fn words_of_handlers_can_be_names() {
    let body = "A.up -> on.up -> wait  A.east -> retry";
    assert_eq!(
        errors(LIMIT, body, "on timeout { release top retry 3 }"),
        []
    );
}

#[test]
fn the_table_lists_retries() {
    let handler = "on timeout { release top wait 20 s retry 3 }";
    let checked = checked(&program(LIMIT, BODY, handler));
    let tables = checked.programs[0].tables.as_ref().unwrap();
    let text = table_text(tables).to_string();
    let phase = text.split("phase top").nth(1).unwrap();
    let phase = phase.split("\n\n").next().unwrap();
    assert_eq!(
        phase,
        ": ends after 2 reports, aborts after 9000 ticks\n    \
         retried after 1 report and 1000 ticks; fails after 3 retries"
    );
}
