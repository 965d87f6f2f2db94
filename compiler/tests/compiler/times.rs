//! Tests times of releases and phases: `release B after 20 s` and `wait 20 s`.
use stochc_compiler::diagnostic::Code;
use stochc_ir::emit::table_text;
use stochc_ir::table::{Action, Tables};

use super::checked;

/// Returns a program whose second phase has this head and body.
fn program(head: &str, body: &str) -> String {
    format!(
        "assembly a {{
            seed plate 1 x 1 {{ M at (0, 0) }}
            phase grow {{ M.up -> A.east -> B  A.west -> C }}
            phase shrink {head} {{ {body} }}
        }}"
    )
}

/// Returns the codes of the diagnostics of a program.
fn codes(head: &str, body: &str) -> Vec<Code> {
    let checked = checked(&program(head, body));
    checked.diagnostics.iter().map(|it| it.code).collect()
}

fn tables(body: &str) -> Tables {
    let mut checked = checked(&program("", body));
    let tables = checked.programs.remove(0).tables;
    tables.unwrap_or_else(|| panic!("{:#?}", checked.diagnostics))
}

/// Returns the delays of all requests, in the order of the tables \[ticks\].
fn delays(body: &str) -> Vec<u32> {
    let tables = tables(body);
    let rules = tables.duties().flat_map(|duty| duty.rules());
    let delays = rules.filter_map(|rule| match rule.then {
        Action::AskRelease => Some(0),
        Action::AskReleaseLater(ticks) => Some(ticks),
        _ => None,
    });
    delays.collect()
}

#[test]
fn a_release_has_a_time() {
    // A tick of the built-in scene lasts 20 ms.
    for (body, expected) in [
        ("release B, C after 20 s", &[1000, 1000][..]),
        ("release B after 7 ticks  release C", &[7, 0]),
        ("release B after 1 us", &[1]),
        ("release B  release C after release B, 1 min", &[0, 3000]),
        ("A.up -> D  release B after D, 2 ticks", &[2]),
        ("A.up -> D  release D after 20 s", &[1000]),
        (
            "A.up -> T[1]  for i in 1..1 { release T[i] after 20 s }",
            &[1000],
        ),
    ] {
        assert_eq!(codes("", body), [], "{body}");
        assert_eq!(delays(body), expected, "{body}");
    }
}

#[test]
fn the_conditions_of_a_release_come_before_its_time() {
    let text = table_text(&tables("A.up -> D  release B after D, 2 ticks")).to_string();
    let rule = "once notified that D is anchored: after 2 ticks, ask to be released";
    assert!(text.contains(rule), "{text}");
}

#[test]
fn a_phase_lasts_as_long_as_its_longest_wait() {
    for (body, expected) in [
        ("wait 20 s", 1000),
        ("wait 20 s  wait 7 ticks", 1000),
        ("release B  wait 30 ticks", 30),
        ("if 2 > 1 { wait 20 s } else { wait 30 s }", 1000),
        ("release B", 0),
    ] {
        assert_eq!(codes("", body), [], "{body}");
        assert_eq!(tables(body).phases[1].wait, expected, "{body}");
    }
    let text = table_text(&tables("wait 20 s")).to_string();
    let phase = "phase shrink: ends after 0 reports and at least 1000 ticks";
    assert!(text.contains(phase), "{text}");
}

#[test]
fn wrong_times_are_reported() {
    for (body, code) in [
        ("A.up -> D after 20 s", Code::Misplaced),
        ("A.up -> D after B, 20 s", Code::Misplaced),
        ("release B after 20 s, C", Code::Syntax),
        ("release B after 20 s after C", Code::Misplaced),
        ("release B after 20", Code::WrongDimension),
        ("release B after 20 m", Code::WrongDimension),
        ("release B after 0 s", Code::WrongDimension),
        ("release B after 1.5 ticks", Code::WrongDimension),
        ("release B after 4294967296 ticks", Code::WrongValue),
        ("wait 0 s", Code::WrongDimension),
    ] {
        assert_eq!(codes("", body)[..1], [code], "{body}");
    }
}

#[test]
fn an_empty_after_lists_a_time_only_for_releases() {
    for (body, expected) in [
        ("release B after", "a block to wait for or a time"),
        ("A.up -> D after", "a block to wait for"),
    ] {
        let checked = checked(&program("", body));
        let title = format!("expected {expected}, found `}}`");
        assert_eq!(checked.diagnostics[0].title, title);
    }
}

#[test]
fn a_wait_longer_than_the_timeout_is_reported() {
    assert_eq!(codes("timeout 20 s", "wait 20 s"), []);
    assert_eq!(codes("timeout 20 s", "wait 21 s"), [Code::ShortTimeout]);
}

#[test]
fn a_wait_belongs_into_a_phase() {
    let outside = "assembly a { seed plate 1 x 1 { M at (0, 0) } wait 20 s phase p { M.up -> A } }";
    let checked = checked(outside);
    assert_eq!(checked.diagnostics[0].code, Code::Misplaced);
}
