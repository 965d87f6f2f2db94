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
            let said = stochc(&format!("{command} {denied} {CARELESS}"));
            assert_eq!(
                (said.status, said.out.as_str()),
                (1, ""),
                "{command} {denied}"
            );
            assert!(
                said.err
                    .contains("error[unused-seed]: seed `N` is never used"),
                "{}",
                said.err
            );
        }
        let said = stochc(&format!("{command} --deny empty-phase {CARELESS}"));
        assert_eq!(said.status, 0, "{command}: {}", said.err);
    }
    let said = stochc(&format!("check --deny warnings --format short {CARELESS}"));
    assert!(said.out.contains(": error[unused-seed]: "), "{}", said.out);
}

#[test]
fn an_allowed_warning_is_counted_and_not_told() {
    let said = stochc(&format!("check --allow unused-seed {CARELESS}"));
    assert_eq!((said.status, said.err.as_str()), (0, ""));
    assert!(
        said.out.contains("1 phase, 1 warning allowed\n"),
        "{}",
        said.out
    );
}

#[test]
fn the_last_word_of_the_command_line_counts() {
    for (options, status) in [
        ("--deny warnings --warn unused-seed", 0),
        ("--warn unused-seed --deny warnings", 1),
        ("--deny unused-seed --allow warnings", 0),
        ("--allow warnings --deny unused-seed", 1),
    ] {
        let said = stochc(&format!("check {options} {CARELESS}"));
        assert_eq!(said.status, status, "{options}: {}", said.err);
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
            let said = stochc(&format!("check {option} {code} {CARELESS}"));
            assert_eq!(said.status, 2, "{option} {code}");
            assert!(said.err.contains(reason), "{}", said.err);
        }
    }
    let said = stochc("explain unused-sede");
    assert!(
        said.err.contains("did you mean `unused-seed`?"),
        "{}",
        said.err
    );
}

#[test]
fn the_file_counts_more_than_the_command_line() {
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
        let said = stochc_with(&format!("check {options}"), &[&file]);
        assert_eq!((said.status, said.err.as_str()), (0, ""), "{options}");
    }
    program("deny unused-seed \"every seed has a tower\"");
    for options in ["", "--allow warnings", "--warn unused-seed"] {
        let said = stochc_with(&format!("check {options}"), &[&file]);
        assert_eq!(said.status, 1, "{options}");
        assert!(
            said.err.contains("denied here: every seed has a tower"),
            "{}",
            said.err
        );
    }
}
