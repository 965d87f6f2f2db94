//! Tests warnings that are allowed or denied, in the source and on the command line.
use crate::stochc::{path, stochc, stochc_with};

const CARELESS: &str = "tests/fixtures/careless.sa";

#[test]
fn a_denied_warning_is_an_error_for_every_command() {
    for command in ["check", "compile", "simulate --runs 1 --quiet"] {
        for denied in [
            "--deny unused-seed",
            "--deny warnings",
            "--deny=empty-phase,unused-seed",
        ] {
            let outcome = stochc(&format!("{command} {denied} {CARELESS}"));
            assert_eq!(
                (outcome.status, outcome.out.as_str()),
                (1, ""),
                "{command} {denied}"
            );
            assert!(
                outcome
                    .err
                    .contains("error[unused-seed]: seed `N` is never used"),
                "{}",
                outcome.err
            );
        }
        let outcome = stochc(&format!("{command} --deny empty-phase {CARELESS}"));
        assert_eq!(outcome.status, 0, "{command}: {}", outcome.err);
    }
    let outcome = stochc(&format!("check --deny warnings --format short {CARELESS}"));
    assert!(
        outcome.out.contains(": error[unused-seed]: "),
        "{}",
        outcome.out
    );
}

#[test]
fn an_allowed_warning_is_counted_but_not_printed() {
    let outcome = stochc(&format!("check --allow unused-seed {CARELESS}"));
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    assert!(
        outcome.out.contains("1 phase, 1 warning allowed\n"),
        "{}",
        outcome.out
    );
}

#[test]
fn the_last_level_on_the_command_line_applies() {
    for (options, status) in [
        ("--deny warnings --warn unused-seed", 0),
        ("--warn unused-seed --deny warnings", 1),
        ("--deny unused-seed --allow warnings", 0),
        ("--allow warnings --deny unused-seed", 1),
    ] {
        let outcome = stochc(&format!("check {options} {CARELESS}"));
        assert_eq!(outcome.status, status, "{options}: {}", outcome.err);
    }
}

#[test]
fn codes_of_the_command_line_are_checked() {
    for (code, reason) in [
        ("cycle", "`cycle` is always an error"),
        ("unused-sede", "did you mean `unused-seed`?"),
        ("nonsense", "`stochc explain` lists all codes"),
    ] {
        for option in ["--allow", "--warn", "--deny"] {
            let outcome = stochc(&format!("check {option} {code} {CARELESS}"));
            assert_eq!(outcome.status, 2, "{option} {code}");
            assert!(outcome.err.contains(reason), "{}", outcome.err);
        }
    }
    let outcome = stochc("explain unused-sede");
    assert!(
        outcome.err.contains("did you mean `unused-seed`?"),
        "{}",
        outcome.err
    );
}

#[test]
fn levels_in_the_file_override_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "levels.sa");
    let program = |statement: &str| {
        let text = format!(
            "assembly a {{\n {statement}\n seed plate 2 x 1 {{ M at (0, 0)  N at (1, 0) }}\n \
             phase p {{ M.up -> A }} }}"
        );
        std::fs::write(&file, text).unwrap();
    };
    program("allow unused-seed \"a mark\"");
    for options in ["", "--deny warnings", "--deny unused-seed"] {
        let outcome = stochc_with(&format!("check {options}"), &[&file]);
        assert_eq!((outcome.status, outcome.err.as_str()), (0, ""), "{options}");
    }
    program("deny unused-seed \"every seed has a tower\"");
    for options in ["", "--allow warnings", "--warn unused-seed"] {
        let outcome = stochc_with(&format!("check {options}"), &[&file]);
        assert_eq!(outcome.status, 1, "{options}");
        assert!(
            outcome.err.contains("denied here: every seed has a tower"),
            "{}",
            outcome.err
        );
    }
}
