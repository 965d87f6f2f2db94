//! Tests aggregates: free blocks that bond to each other without a plate.
use std::fs;

use crate::stochc::{path, stochc, stochc_with};

const FILE: &str = "tests/fixtures/aggregate.sa";

#[test]
fn an_aggregate_is_summarized_in_a_line() {
    let outcome = stochc("check --cost=3 tests/fixtures/aggregate.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    for line in [
        "two: an aggregate of 2 of 6 free blocks\n  not proved: chance decides what an aggregate builds\n",
        "four: an aggregate of 4 of 6 free blocks\n  not proved: chance decides what an aggregate builds\n",
        "tower: 1 capture in 1 phase\n  proved: completes in every order\n",
    ] {
        assert!(outcome.out.contains(line), "{line} in {}", outcome.out);
    }
    assert_eq!(stochc("fmt --check tests/fixtures/aggregate.sa").status, 0);
    assert_eq!(
        stochc("check --physics tests/fixtures/aggregate.sa").status,
        0
    );
}

#[test]
fn every_stage_of_an_aggregate_can_be_printed() {
    for (emit, format) in [
        ("graph", "text"),
        ("graph", "json"),
        ("graph", "dot"),
        ("structure", "text"),
        ("structure", "json"),
        ("structure", "svg"),
        ("table", "json"),
    ] {
        let outcome = stochc(&format!("compile --emit {emit} --format {format} {FILE}"));
        assert_eq!(
            (outcome.status, outcome.err.as_str()),
            (0, ""),
            "{emit} {format}"
        );
        assert!(!outcome.out.is_empty(), "{emit} {format}");
    }
    let table = stochc(&format!("compile {FILE}")).out;
    let two = "aggregate two\nno plate: every face always attracts, until 2 free blocks are bonded\n\n\
               phase 2: ends when a group has 2 blocks, fails after 15000 ticks\n";
    assert!(table.starts_with(two), "{table}");
    assert!(
        table.contains("phase 4: ends when a group has 4 blocks\n"),
        "{table}"
    );
    let json = stochc(&format!("compile --format json {FILE}")).json();
    let program = &json["programs"][1];
    assert_eq!(program["aggregate"], 4);
    assert_eq!(program["plate"]["width"], 0);
    assert_eq!(program["blocks"].as_array().unwrap().len(), 0);
    let outcome = stochc(&format!(
        "compile --emit structure --format svg --program four {FILE}"
    ));
    assert_eq!((outcome.status, outcome.out.as_str()), (2, ""));
    assert!(
        outcome.err.contains("an aggregate has no picture"),
        "{}",
        outcome.err
    );
}

#[test]
fn phases_of_an_aggregate_are_its_sizes() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "runs");
    let arguments = [FILE, "--runs", "30", "--out", &out, "--captures"];
    let outcome = stochc_with("simulate --model shuffle --quiet", &arguments);
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    // The three programs are columns of the same table.
    assert_eq!(outcome.row("Captures"), ["2", "4", "1"]);
    let none = "\ntwo, an aggregate, has no captures: its blocks bond when they meet.\n";
    assert!(outcome.out.contains(none), "{}", outcome.out);
    assert_eq!(outcome.out.matches("capture by capture").count(), 1);
    let journal = fs::read_to_string(path(folder.path(), "runs/journal.jsonl")).unwrap();
    let mut largest = Vec::new();
    for line in journal.lines().skip(1) {
        let value: serde_json::Value = serde_json::from_str(line).unwrap();
        let record = &value["record"];
        assert_eq!(record["outcome"]["kind"], "completed");
        let ticks: Vec<u64> = serde_json::from_value(record["phase_ticks"].clone()).unwrap();
        assert_eq!(record["ticks"], ticks.iter().sum::<u64>());
        if value["program"] == 1 {
            assert_eq!(ticks.len(), 3);
            assert!(ticks[0] > 0, "no blocks are bonded at the beginning");
            assert_eq!(record["bonds"].as_array().unwrap().len(), 0);
            largest.push(record["blocks_used"].as_u64().unwrap());
        }
    }
    assert_eq!(largest.len(), 30);
    // When two groups bond, the result may exceed the requested size.
    assert!(
        largest.iter().all(|size| (4..=6).contains(size)),
        "{largest:?}"
    );
    let again = stochc_with("show --captures", &[&out]);
    assert_eq!((again.status, again.out), (0, outcome.out));
    let page = path(folder.path(), "page");
    let report = stochc_with("report", &[&out, "--out", &page]);
    assert_eq!(report.status, 0, "{}", report.err);
    // `trace` prints the same run as text.
    let trace = stochc_with("trace --model shuffle --run 3", &[FILE]);
    assert!(
        trace
            .out
            .contains("four, run 3\n  phase 2, from tick 0 (0 s)\n"),
        "{}",
        trace.out
    );
}

#[test]
fn a_size_that_is_not_reached_in_time_is_censored() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "late.sa");
    let text = fs::read_to_string(FILE).unwrap();
    fs::write(&file, text.replace("timeout 300 s", "timeout 1 tick")).unwrap();
    let arguments = [file.as_str(), "--runs", "40", "--json"];
    let outcome = stochc_with("simulate --model shuffle --quiet", &arguments);
    assert_eq!(outcome.status, 3);
    let two = &outcome.json()["programs"][0];
    let late = two["timed_out"].as_u64().unwrap();
    assert!(
        (10..40).contains(&late),
        "every other tick two blocks are drawn: {late}"
    );
    assert_eq!(two["completed"], 40 - late);
    // The limit of the command stops a run in a phase before the size of this phase is reached.
    let mut sizes = std::collections::BTreeSet::new();
    for run in 0..12 {
        let run = run.to_string();
        let limited = ["--max-ticks", "3", "--run", &run, "--json", FILE];
        let outcome = stochc_with("trace --model shuffle", &limited);
        let record = &outcome.json()["runs"][1];
        let reached = record["phase_ticks"].as_array().unwrap().len() as u64;
        if record["outcome"]["kind"] == "timed_out" {
            assert_eq!(
                (&record["outcome"]["phase"], &record["ticks"]),
                (&reached.into(), &3.into())
            );
            sizes.insert(reached);
        }
    }
    assert!(sizes.len() > 1, "{sizes:?}");
}

#[test]
fn an_aggregate_runs_in_the_physical_models() {
    let folder = tempfile::tempdir().unwrap();
    for (model, substeps) in [("rigid", "4"), ("rapier", "1")] {
        let out = path(folder.path(), model);
        let arguments = [
            "--model",
            model,
            "--substeps",
            substeps,
            "--out",
            &out,
            FILE,
        ];
        let line = "simulate --quiet --runs 1 --max-ticks 20 --record all";
        let outcome = stochc_with(line, &arguments);
        // No blocks meet within this small number of ticks.
        assert_eq!(outcome.status, 3, "{model}: {}", outcome.err);
        let page = path(folder.path(), &format!("{model}.html"));
        let program = ["--program", "four", "--run", "0", "--out", &page];
        let replayed = stochc_with("replay", &[&[out.as_str()], &program[..]].concat());
        assert_eq!(replayed.status, 0, "{model}: {}", replayed.err);
    }
}

#[test]
fn an_aggregate_cannot_be_completed_by_a_plan() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let simulate = "simulate --model shuffle --runs 1 --quiet --out";
    assert_eq!(stochc_with(simulate, &[&out, FILE]).status, 0);
    let outcome = stochc_with("plan --run 0 --program two", &[&out]);
    assert_eq!((outcome.status, outcome.out.as_str()), (2, ""));
    assert!(
        outcome
            .err
            .contains("is an aggregate: it grows at random and cannot be planned"),
        "{}",
        outcome.err
    );
}

#[test]
fn impossible_aggregates_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "wrong.sa");
    for (text, code) in [
        ("aggregate a to 2", "cannot-aggregate"),
        ("aggregate a in suction_tank to 2", "cannot-aggregate"),
        ("aggregate a in magnet_tank to 1", "wrong-value"),
        ("aggregate a in magnet_tank to 10001", "wrong-value"),
        ("aggregate a in magnet_tank to 9000", "too-few-blocks"),
        ("aggregate a in nowhere to 2", "unknown-scene"),
        ("aggregate a in magnet_tank to n", "unknown-name"),
        (
            "aggregate a in magnet_tank to 2 timeout 3 m",
            "wrong-dimension",
        ),
        (
            "aggregate a in magnet_tank to 2 aggregate a in magnet_tank to 2",
            "duplicate-name",
        ),
        ("aggregate a in magnet_tank", "syntax"),
        ("aggregate phase in magnet_tank to 2", "reserved-word"),
        (
            "assembly b { aggregate a in magnet_tank to 2 }",
            "misplaced",
        ),
    ] {
        fs::write(&file, format!("{text}\n")).unwrap();
        let outcome = stochc_with("check", &[&file]);
        assert_eq!(outcome.status, 1, "{text}: {}", outcome.out);
        assert!(outcome.err.contains(code), "{text}: {}", outcome.err);
    }
    // The keywords of aggregates can be used as names.
    let text = "assembly a {\n    seed plate 1 x 1 { to at (0, 0) }\n    phase p { to.up -> aggregate }\n}\n";
    fs::write(&file, text).unwrap();
    assert_eq!(stochc_with("check", &[&file]).status, 0);
}
