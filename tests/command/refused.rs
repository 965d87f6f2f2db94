//! Tests commands that are rejected before the first run.
use std::fs;

use crate::stochc::{path, stochc, stochc_with, tables};

const TOWER: &str = "simulate --model shuffle --quiet tests/fixtures/tower.sa --runs 3";

#[test]
fn invalid_command_lines_are_reported() {
    for line in [
        "",
        "chekc",
        "check",
        "check --format xml tests/fixtures/tower.sa",
        "compile",
        "compile --emit nothing tests/fixtures/tower.sa",
        "show",
        "simulate",
        "simulate --bogus tests/fixtures/tower.sa",
        "simulate --runs 0 tests/fixtures/tower.sa",
        "simulate --runs many tests/fixtures/tower.sa",
        "simulate --substeps 0 tests/fixtures/tower.sa",
        "simulate --solver-iterations 0 tests/fixtures/tower.sa",
        "simulate --max-ticks 0 tests/fixtures/tower.sa",
        "simulate --threads 0 tests/fixtures/tower.sa",
        "simulate --threads 100000 tests/fixtures/tower.sa",
        "simulate --seed -1 tests/fixtures/tower.sa",
        "plan --tries -5 tests/fixtures/tower.sa",
        "shard run tests/fixtures -1",
        "simulate --model magic tests/fixtures/tower.sa",
        "simulate --resume tests/fixtures/tower.sa",
        "sweep tests/fixtures/tower.sa",
        "shard",
        "shard new tests/fixtures/tower.sa --out nowhere",
        "trace --run 1 --runs 2 tests/fixtures/tower.sa",
        "trace --run 1 --out nowhere tests/fixtures/tower.sa",
    ] {
        let outcome = stochc(line);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{line}");
        assert!(
            outcome.err.contains("Usage") || outcome.err.contains("--help"),
            "{line}: {}",
            outcome.err
        );
        // A negative number is a value, so the message does not treat it as an option.
        assert!(!outcome.err.contains("as a value, use"), "{}", outcome.err);
    }
    assert!(
        stochc("simulate --seed -1 tests/fixtures/tower.sa")
            .err
            .contains("'-1' for '--seed")
    );
}

/// Checks that an option without effect is rejected, even if another option excludes the option
/// that it needs.
#[test]
fn an_option_without_effect_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    for line in [
        "simulate FILE --checkpoints 3s",
        "trace FILE --checkpoints 3s --run 3",
        "shard new FILE --checkpoints 3s --out OUT --shards 3",
        "simulate FILE --mixed-builds --out OUT",
        "shard new FILE --captures --out OUT --shards 3",
        "shard new FILE --json --out OUT --shards 3",
        "simulate FILE --record 1",
        "trace FILE --record 1 --run 1",
        "simulate FILE --record-every 5 --out OUT",
        "sweep FILE --figure-width 89mm --vary free=4,5",
        "simulate FILE --figure-width 89mm --out OUT",
        "simulate FILE --time 3s --model rigid",
        "simulate FILE --model shuffle --substeps 4",
        "simulate FILE --model shuffle --solver-iterations 4",
        "simulate FILE --model shuffle --precision double",
        "simulate FILE --model shuffle --without corners",
        "simulate FILE --model rate --without corners",
        "simulate FILE --model rapier --without corners",
        "simulate FILE --model rapier --precision double",
        "simulate FILE --rates none.rates",
        "simulate FILE --model shuffle --rates none.rates",
        "plan FILE --complete --dead unknown",
        "plan FILE --complete --program unknown",
        "estimate FILE --seed 5",
        "estimate FILE --max-ticks 500",
        "compile FILE --emit executable --format text",
    ] {
        let words: Vec<_> = (line.split(' '))
            .map(|word| match word {
                "FILE" => "tests/fixtures/tower.sa",
                "OUT" => out.as_str(),
                word => word,
            })
            .collect();
        let outcome = stochc_with("", &words);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{line}");
        assert!(
            outcome.err.starts_with("error: "),
            "{line}: {}",
            outcome.err
        );
        assert!(!std::path::Path::new(&out).exists(), "{line}");
    }
}

/// Checks suggestions for names of commands in other programs, and for a file without a command.
#[test]
fn a_similar_command_is_suggested() {
    for (line, suggestion) in [
        ("run tests/fixtures/tower.sa", "stochc simulate"),
        ("init", "stochc new"),
        ("version", "stochc --version"),
        (
            "tests/fixtures/tower.sa",
            "stochc check tests/fixtures/tower.sa",
        ),
    ] {
        let outcome = stochc(line);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{line}");
        let tip = format!("did you mean `{suggestion}`?");
        assert!(outcome.err.contains(&tip), "{line}: {}", outcome.err);
    }
}

/// Checks that every command is in a group, and that the help has a readable width.
#[test]
fn help_is_grouped_and_wrapped() {
    let help = stochc("--help").out;
    let command = <stochc::cli::Cli as clap::CommandFactory>::command();
    for subcommand in command.get_subcommands() {
        let row = format!("\n  {:12}", subcommand.get_name());
        assert!(help.contains(&row), "{row}: {help}");
    }
    for group in [
        "Write:",
        "Run:",
        "Look:",
        "Trust:",
        "Many machines:",
        "Keep:",
    ] {
        assert!(help.contains(group), "{help}");
    }
    for subcommand in command.get_subcommands() {
        let help = stochc_with("help", &[subcommand.get_name()]).out;
        let wide = help.lines().find(|line| line.chars().count() > 100);
        assert_eq!(wide, None, "{}", subcommand.get_name());
    }
}

#[test]
fn help_and_version_are_output() {
    for line in [
        "--help",
        "--version",
        "help simulate",
        "simulate --help",
        "check -h",
    ] {
        let outcome = stochc(line);
        assert_eq!((outcome.status, outcome.err.as_str()), (0, ""), "{line}");
        assert!(!outcome.out.is_empty());
    }
    let help = stochc("--help").out;
    let (_, statuses) = help.split_once("Exit status:").unwrap();
    for status in ["0", "1", "2", "3", "130"] {
        assert!(statuses.contains(&format!(" {status} ")), "{statuses}");
    }
}

#[test]
fn a_program_with_errors_is_not_run() {
    let outcome = stochc("simulate tests/fixtures/tower.sa tests/fixtures/wrong.sa");
    assert_eq!((outcome.status, outcome.out.as_str()), (1, ""));
    assert!(outcome.err.contains("unknown-name"), "{}", outcome.err);
    let outcome = stochc("simulate tests/fixtures/importing_tower.sa");
    assert_eq!((outcome.status, outcome.out.as_str()), (2, ""));
    assert!(outcome.err.contains("no assembly"), "{}", outcome.err);
}

#[test]
fn a_scene_that_does_not_fit_is_not_run() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let outcome = stochc_with(
        "simulate tests/fixtures/dense.sa tests/fixtures/crowded.sa --out",
        &[&out],
    );
    assert_eq!((outcome.status, outcome.out.as_str()), (1, ""));
    assert!(
        outcome.err.contains("crowded: 400 free blocks do not fit"),
        "{}",
        outcome.err
    );
    assert!(!fs::exists(&out).unwrap());
}

#[test]
fn a_scene_with_a_term_that_the_model_lacks_is_not_run() {
    let outcome = stochc("simulate --model rapier tests/fixtures/soft.sa --runs 1");
    assert_eq!((outcome.status, outcome.out.as_str()), (1, ""));
    let reason =
        "soft: the model `rapier` does not support contact with a `stiffness`; use `--model rigid`";
    assert!(outcome.err.contains(reason), "{}", outcome.err);
}

#[test]
fn the_rigid_model_supports_what_rapier_lacks() {
    let outcome = stochc("simulate --model rigid tests/fixtures/soft.sa --runs 2 --quiet");
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(outcome.out.contains("Mean time"), "{}", outcome.out);
    let fixture = "tests/fixtures/dense.sa --runs 1 --quiet";
    for option in ["--precision double", "--without corners"] {
        let outcome = stochc(&format!("simulate --model rapier {option} {fixture}"));
        assert_eq!(outcome.status, 2, "{}", outcome.err);
        let (name, _) = option.split_once(' ').unwrap();
        let reason = format!("the model `rapier` has no `{name}`; `--model rigid` has it");
        assert!(outcome.err.contains(&reason), "{}", outcome.err);
        let outcome = stochc(&format!("simulate --model rigid {option} {fixture}"));
        assert_eq!(outcome.status, 0, "{}", outcome.err);
    }
}

#[test]
fn a_finished_folder_is_shown_again() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "deep/er/out");
    let first = stochc_with(TOWER, &["--out", &out]);
    assert_eq!((first.status, first.err.as_str()), (0, ""));
    let before = tables(&out);
    let again = stochc_with(&TOWER.replace(" --quiet", ""), &["--out", &out]);
    assert_eq!((again.status, again.out), (0, first.out));
    assert!(again.err.contains("finished already"), "{}", again.err);
    assert!(before == tables(&out));
}

#[test]
fn other_results_are_never_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    stochc_with(TOWER, &["--out", &out]);
    let before = tables(&out);
    const DENSE: &str = "simulate --quiet tests/fixtures/dense.sa --runs 1";
    let with_physics = path(folder.path(), "with_physics");
    assert_eq!(stochc_with(DENSE, &["--out", &with_physics]).status, 0);
    let seed = "the seed is `1` there and `2` here";
    for (line, out, more, reason) in [
        (TOWER, &out, &["--seed", "2"][..], seed),
        (TOWER, &out, &["--max-ticks", "7"], "the limit of ticks"),
        (
            TOWER,
            &out,
            &["tests/fixtures/late.sa"],
            "`tower, late` here",
        ),
        (
            DENSE,
            &with_physics,
            &["--substeps", "7"],
            "the number of substeps",
        ),
        (
            DENSE,
            &with_physics,
            &["--solver-iterations", "7"],
            "`solver-iterations`",
        ),
    ] {
        let outcome = stochc_with(line, &[&["--out", out], more].concat());
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{more:?}");
        assert!(outcome.err.contains(reason), "{}", outcome.err);
    }
    let outcome = stochc_with("resume --runs 2", &[&out]);
    assert_eq!(outcome.status, 2, "no run is thrown away");
    assert!(before == tables(&out));
}

#[test]
fn foreign_files_are_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let note = path(folder.path(), "note.txt");
    fs::write(&note, "mine").unwrap();
    let mine = folder.path().to_str().unwrap();
    let outcome = stochc_with(TOWER, &["--out", mine]);
    assert_eq!(outcome.status, 2);
    assert!(
        outcome.err.contains("contains other files"),
        "{}",
        outcome.err
    );
    let outcome = stochc_with(TOWER, &["--out", &note]);
    assert_eq!(outcome.status, 2);
    assert!(outcome.err.contains("is a file"), "{}", outcome.err);
    assert_eq!(fs::read_dir(mine).unwrap().count(), 1);
}

#[test]
fn recording_a_run_beyond_the_ensemble_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    for (runs, record, expected) in [
        ("2", "9", "--record: run 9 is not among runs 0..1"),
        ("2", "0,9", "--record: run 9 is not among runs 0..1"),
        ("2", "0..4", "--record: run 2 is not among runs 0..1"),
        ("1", "1", "--record: run 1 is not there: the only run is 0"),
    ] {
        let line = "simulate --quiet tests/fixtures/dense.sa --runs";
        let outcome = stochc_with(line, &[runs, "--record", record, "--out", &out]);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{record}");
        assert!(outcome.err.contains(expected), "{record}: {}", outcome.err);
        assert!(!folder.path().join("out").exists(), "nothing was begun");
    }
}

#[test]
fn zero_is_not_a_valid_count() {
    for line in [
        "check --cost=0 tests/fixtures/tower.sa",
        "verify --states 0 tests/fixtures/tower.sa",
    ] {
        let outcome = stochc(line);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{line}");
    }
}

/// Checks arguments that are not UTF-8. If one of several is invalid, the message names it.
#[test]
#[cfg(unix)]
fn an_argument_that_is_not_text_is_named() {
    use std::os::unix::ffi::OsStrExt as _;
    let mut command = crate::stochc::command(["check", "tests/fixtures/tower.sa"]);
    command.arg(std::ffi::OsStr::from_bytes(b"caf\xe9.sa"));
    let outcome = crate::stochc::run_command(&mut command);
    assert_eq!((outcome.status, outcome.out.as_str()), (2, ""));
    assert!(
        outcome
            .err
            .starts_with("error: `caf\u{fffd}.sa` is not in UTF-8"),
        "{}",
        outcome.err
    );
}
