//! Ensembles without physics: the shuffle does a capture a tick.
use crate::stochc::{path, stochc, stochc_with, tables};

const TOWER: &str = "simulate --model shuffle --quiet tests/fixtures/tower.sa";

#[test]
fn the_table_is_the_output() {
    let said = stochc("simulate --model shuffle --runs 5 tests/fixtures/tower.sa");
    assert_eq!(said.status, 0);
    assert!(said.err.starts_with("5 of 5 runs, after "), "{}", said.err);
    insta::assert_snapshot!(said.out);
    let quiet = stochc_with(TOWER, &["--runs", "5"]);
    assert_eq!((quiet.status, quiet.err.as_str()), (0, ""));
    assert_eq!(quiet.out, said.out);
}

#[test]
fn programs_are_compared() {
    let said = stochc_with(TOWER, &["tests/fixtures/importing.sa", "--runs", "3"]);
    assert_eq!(said.status, 0, "{}", said.err);
    insta::assert_snapshot!(said.out);
    // The same program twice is two programs.
    let said = stochc_with(TOWER, &["tests/fixtures/tower.sa", "--runs", "3"]);
    assert!(said.out.contains("tower (2)"), "{}", said.out);
}

#[test]
fn figures_come_as_json_too() {
    let figures = stochc_with(TOWER, &["--runs", "4", "--format", "json"]).json();
    assert_eq!(figures["programs"][0]["completed"], 4);
    assert_eq!(figures["programs"][0]["time"]["mean"], 3.0);
    let both = stochc_with(TOWER, &["--runs", "4", "--format", "json", "--bonds"]).json();
    assert_eq!(both["comparison"], figures);
    assert_eq!(both["captures"][0].as_array().unwrap().len(), 3);
}

#[test]
fn captures_are_told_on_request() {
    let said = stochc_with(TOWER, &["--runs", "4", "--bonds"]);
    let (_, captures) = said.out.split_once("tower, capture by capture\n").unwrap();
    for edge in ["foot: M -> A", "top: A -> B", "top: B -> C"] {
        assert!(captures.contains(edge), "{captures}");
    }
}

#[test]
fn a_timeout_is_censored_and_a_status() {
    let said = stochc("simulate --model shuffle --runs 3 tests/fixtures/late.sa");
    assert_eq!(said.status, 3);
    let told = "3 of 3 runs, 3 timed out, after ";
    assert!(said.err.starts_with(told), "{}", said.err);
    assert_eq!(said.row("Timed out (censored)"), ["3"]);
    assert_eq!(said.row("Mean time to completion"), ["≥", "2", "(to", "2)"]);
    assert_eq!(said.row("SD"), ["-"], "unknown");
    assert!(
        said.out
            .contains("≥: some runs were stopped before they completed")
    );
    // The limit of the command is censored like the program's own.
    let said = stochc_with(TOWER, &["--runs", "3", "--max-ticks", "2"]);
    assert_eq!(said.status, 3);
    assert_eq!(said.row("Timed out (censored)"), ["3"]);
    let said = stochc("simulate --model shuffle --run 0 tests/fixtures/late.sa");
    assert_eq!(said.status, 3);
    assert!(
        said.out.contains("timed out in phase grow after 2 ticks"),
        "{}",
        said.out
    );
}

#[test]
fn threads_do_not_matter() {
    let folder = tempfile::tempdir().unwrap();
    let [one, four] = ["1", "4"].map(|threads| {
        let out = path(folder.path(), threads);
        let said = stochc_with(
            TOWER,
            &[
                "tests/fixtures/importing.sa",
                "--threads",
                threads,
                "--out",
                &out,
            ],
        );
        assert_eq!(said.status, 0, "{}", said.err);
        (tables(&out), said.out)
    });
    assert!(one == four);
    let other = path(folder.path(), "other");
    stochc_with(
        TOWER,
        &[
            "tests/fixtures/importing.sa",
            "--seed",
            "2",
            "--out",
            &other,
        ],
    );
    assert!(one.0 != tables(&other), "the seed does");
}

#[test]
fn one_run_is_that_of_the_ensemble() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    stochc_with(TOWER, &["--runs", "4", "--seed", "7", "--out", &out]);
    let journal = std::fs::read_to_string(path(out.as_ref(), "journal.jsonl")).unwrap();
    let records = journal.lines().skip(1).map(|line| {
        let line: serde_json::Value = serde_json::from_str(line).unwrap();
        line["record"].clone()
    });
    let records: Vec<_> = records.collect();
    assert_eq!(records.len(), 4);
    for record in records {
        let run = record["run"].to_string();
        let said = stochc_with(TOWER, &["--seed", "7", "--format", "json", "--run", &run]);
        assert_eq!(said.json(), serde_json::json!([record]), "run {run}");
    }
}

#[test]
fn a_run_is_told_capture_by_capture() {
    let said = stochc("simulate --model shuffle --run 1 tests/fixtures/tower.sa");
    assert_eq!((said.status, said.err.as_str()), (0, ""));
    let told = without_blocks(&said.out);
    insta::assert_snapshot!(told);
}

/// The text with `N` for the numbers of blocks, which chance decides.
fn without_blocks(text: &str) -> String {
    let line = |line: &str| match line.split_once(": block ") {
        Some((before, _)) => format!("{before}: block N\n"),
        None => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}
