//! Tests small trades whose runs take milliseconds.
use std::fs;

use serde_json::Value;

use crate::stochc::{path, stochc, stochc_with};

/// Command line with three runs for each combination of settings, and almost no refinement.
const DENSE: &str = "trade tests/fixtures/dense.sa --runs 3 --finest 2 --quiet";

fn candidates(trade: &Value) -> &Vec<Value> {
    trade["candidates"].as_array().unwrap()
}

fn candidate<'a>(trade: &'a Value, name: &str) -> &'a Value {
    let found = candidates(trade)
        .iter()
        .find(|candidate| candidate["name"] == name);
    found.unwrap_or_else(|| panic!("no candidate `{name}`"))
}

/// Removes the measured CPU times from the JSON of a trade.
fn without_costs(value: &mut Value) {
    match value {
        Value::Object(fields) => {
            fields.retain(|name, _| {
                ![
                    "cost",
                    "cost_ratio",
                    "cost_of_tick",
                    "front",
                    "advice",
                    "threads",
                ]
                .contains(&name.as_str())
            });
            fields.values_mut().for_each(without_costs);
        }
        Value::Array(values) => values.iter_mut().for_each(without_costs),
        _ => {}
    }
}

#[test]
fn every_setting_is_measured_and_saved() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let outcome = stochc_with(DENSE, &["--out", &out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert_eq!(
        outcome.err, "",
        "notes on settings left out are not for `--quiet`"
    );
    assert!(!outcome.out.contains(" rate "), "{}", outcome.out);
    // The folder can be read like the folder of a sweep.
    for command in ["show", "report", "fsck"] {
        let other = stochc_with(command, &[&out]);
        assert_eq!(other.status, 0, "{command}: {}", other.err);
    }
    let shown = stochc_with("show", &[&out]).out;
    assert!(shown.contains("dense [model=rigid, substeps=1]"), "{shown}");
    assert!(shown.contains("CPU/run"), "{shown}");
    let page = fs::read_to_string(path(out.as_ref(), "report.html")).unwrap();
    assert!(page.contains("Speed against accuracy"), "no section");
    assert!(
        page.contains("<bdi>--model rigid --substeps 1</bdi></code>"),
        "no row"
    );
    let again = stochc_with(DENSE, &["--out", &out, "--resume"]);
    assert_eq!(
        (again.status, again.out.as_str()),
        (0, outcome.out.as_str())
    );
    let text = fs::read_to_string(path(out.as_ref(), "trade.json")).unwrap();
    let trade: Value = serde_json::from_str(&text).unwrap();
    for candidate in candidates(&trade) {
        let cell = &candidate["programs"][0];
        assert_eq!(cell["runs"], 3, "{}", candidate["name"]);
        assert!(cell["mean"].as_f64().unwrap() > 1.0);
        assert!(cell["cost"].as_f64().unwrap() > 0.0);
        let name = candidate["name"].as_str().unwrap();
        let line = outcome
            .out
            .lines()
            .find(|line| line.contains(&format!(" {name} ")));
        assert!(line.is_some(), "{name}: {}", outcome.out);
    }
    assert_eq!(trade["reference"]["candidate"], 1, "rigid 2");
    assert_eq!(
        candidates(&trade)[1]["options"],
        "--model rigid --substeps 2"
    );
    assert_eq!(
        trade["reference"]["convergence"], "not_converged",
        "the only doubling has changed the mean"
    );
    assert!(outcome.out.contains("NOT CONVERGED"), "{}", outcome.out);
    assert!(
        outcome
            .out
            .contains(trade["advice"].as_str().unwrap().split(' ').next().unwrap())
    );
    assert!(!outcome.out.contains('\u{1b}'), "no colours into a pipe");

    // The runs equal the runs of `simulate` with the same options.
    let alone = stochc(
        "simulate tests/fixtures/dense.sa --model rigid --substeps 1 --runs 3 --quiet --json",
    );
    let mean = &candidate(&trade, "rigid 1")["programs"][0]["mean"];
    assert_eq!(&alone.json()["programs"][0]["time"]["mean"], mean);

    // Another trade must not replace the folder.
    let other = stochc_with(DENSE, &["--out", &out, "--seed", "2"]);
    assert_eq!((other.status, other.out.as_str()), (2, ""));
    assert!(
        other.err.contains("contains another ensemble"),
        "{}",
        other.err
    );
}

#[test]
fn the_picture_has_a_mark_for_every_setting() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let trade = stochc_with(DENSE, &["--json", "--out", &out]).json();
    let text = fs::read_to_string(path(out.as_ref(), "trade.svg")).unwrap();
    let picture = roxmltree::Document::parse(&text).unwrap();
    let marks = picture.descendants().filter(|node| {
        node.attribute("class")
            .is_some_and(|class| class.starts_with("mark "))
    });
    let marks: Vec<_> = marks.collect();
    let measured = candidates(&trade)
        .iter()
        .filter(|candidate| !candidate["cost"].is_null());
    assert_eq!(marks.len(), measured.count());
    let of = |class: &str| {
        let class = format!("mark {class}");
        marks
            .iter()
            .filter(|node| node.attribute("class") == Some(&class))
            .count()
    };
    assert_eq!((of("s2"), of("reference"), of("hot")), (4, 1, 0));
    for mark in &marks {
        let label = (mark.descendants()).find(|node| node.tag_name().name() == "title");
        let label = label.and_then(|title| title.text());
        assert!(label.unwrap().starts_with("--model "));
    }
    let axes: String = picture
        .descendants()
        .filter_map(|node| node.text())
        .collect();
    assert!(axes.contains("CPU time of a run") && axes.contains("% of the reference"));
    assert!(text.contains("prefers-color-scheme:dark"));
    assert!(
        !text.contains("http:") || text.matches("http:").count() == 1,
        "nothing is loaded"
    );
}

#[test]
fn a_trade_depends_only_on_its_inputs() {
    let of = |threads: &str| {
        let mut trade = stochc_with(DENSE, &["--json", "--threads", threads]).json();
        without_costs(&mut trade);
        trade
    };
    let one = of("1");
    assert_eq!(one, of("3"));
    let mut other = stochc_with(DENSE, &["--json", "--seed", "2"]).json();
    without_costs(&mut other);
    assert_ne!(one["candidates"], other["candidates"], "the seed does");
}

#[test]
fn an_unsupported_model_is_reported_with_the_reason() {
    let outcome = stochc("trade tests/fixtures/soft.sa --runs 2 --finest 1");
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let note = "note: left out, soft [model=rapier, substeps=1]: the model `rapier` does not support contact with a `stiffness`";
    assert!(outcome.err.contains(note), "{}", outcome.err);
    assert!(!outcome.out.contains(" rapier 1 "), "{}", outcome.out);
}

#[test]
fn programs_are_ranked() {
    let outcome =
        stochc("trade tests/fixtures/dense.sa tests/fixtures/dense.sa --runs 2 --finest 1 --quiet");
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(outcome.out.contains("dense (2)"), "{}", outcome.out);
    // The same program is given twice.
    assert!(
        outcome.out.contains("no order to compare"),
        "{}",
        outcome.out
    );
}

#[test]
fn censored_runs_are_reported() {
    let outcome =
        stochc("trade tests/fixtures/still.sa --runs 2 --finest 1 --max-ticks 50 --quiet");
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(
        outcome.out.contains("limit of ticks (50)"),
        "{}",
        outcome.out
    );
    assert!(
        outcome.out.contains("There is no reference"),
        "{}",
        outcome.out
    );
}

#[test]
fn more_runs_repeat_none() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let line = "trade tests/fixtures/dense.sa --finest 2 --quiet --json --runs";
    assert_eq!(stochc_with(line, &["2", "--out", &out]).status, 0);
    let mut more = stochc_with(line, &["4", "--out", &out, "--resume"]).json();
    let journal = fs::read_to_string(path(out.as_ref(), "journal.jsonl")).unwrap();
    let runs = 4 * candidates(&more).len();
    assert_eq!(journal.lines().count(), 1 + runs);
    let mut at_once = stochc_with(line, &["4"]).json();
    without_costs(&mut at_once);
    without_costs(&mut more);
    assert_eq!(more, at_once);
}

/// Checks that no run is started after the time limit. The trade of the finished runs is printed.
#[test]
fn a_budget_is_respected() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "trade");
    let line = "trade tests/fixtures/dense.sa --finest 8 --quiet --json --time";
    let outcome = stochc_with(line, &["2s", "--out", &out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let trade = outcome.json();
    let runs = |trade: &Value| -> Vec<u64> {
        let runs = candidates(trade).iter();
        runs.map(|it| it["programs"][0]["runs"].as_u64().unwrap())
            .collect()
    };
    let before = runs(&trade);
    assert!(before[0] > 0 && before[0] < 10_000, "{before:?}");
    // All combinations of settings have about the same number of runs.
    assert!(
        before.iter().all(|&it| it.abs_diff(before[0]) < 20),
        "{before:?}"
    );
    let resumed = stochc_with(line, &["1s", "--out", &out, "--resume"]);
    assert_eq!(resumed.status, 0, "{}", resumed.err);
    let after = runs(&resumed.json());
    assert!(
        before
            .iter()
            .zip(&after)
            .all(|(before, after)| before <= after)
    );
    assert!(after.iter().sum::<u64>() > before.iter().sum());
}

/// Checks that the settings of a sweep are compared like the settings of a trade.
#[test]
fn a_sweep_over_settings_is_a_trade() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let line =
        "sweep tests/fixtures/dense.sa --runs 3 --quiet --vary substeps=1,2 --vary free=10,12";
    let outcome = stochc_with(line, &["--vary", "without=none,corners", "--out", &out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(
        outcome
            .out
            .contains("dense [free=10, substeps=1, without=none]"),
        "{}",
        outcome.out
    );
    let text = fs::read_to_string(path(out.as_ref(), "trade.json")).unwrap();
    let trade: Value = serde_json::from_str(&text).unwrap();
    let names: Vec<&Value> = candidates(&trade).iter().map(|it| &it["name"]).collect();
    assert_eq!(
        names,
        [
            "rigid 1",
            "rigid 1 no-corners",
            "rigid 2",
            "rigid 2 no-corners"
        ]
    );
    let programs: Vec<&Value> = (trade["programs"].as_array().unwrap().iter())
        .map(|it| &it["name"])
        .collect();
    assert_eq!(programs, ["dense [free=10]", "dense [free=12]"]);
    assert_eq!(trade["reference"]["candidate"], 2);
    // Each point equals an ensemble with the same options, run by run.
    let alone = "sweep tests/fixtures/dense.sa --runs 3 --quiet --json --substeps 1 --vary free=12";
    let mean = &candidate(&trade, "rigid 1")["programs"][1]["mean"];
    assert_eq!(&stochc(alone).json()["programs"][0]["time"]["mean"], mean);
    let csv = fs::read_to_string(path(out.as_ref(), "sweep.csv")).unwrap();
    assert!(
        csv.starts_with("program,free,substeps,without,runs,"),
        "{csv}"
    );
    for (line, reason) in [
        ("--vary model=rigid,rapid", "`model=rapid`: give one of"),
        (
            "--vary model=rigid,rapier --vary precision=double",
            "does not use all",
        ),
        ("--vary substeps=1,1", "is given twice"),
    ] {
        let outcome = stochc(&format!(
            "sweep tests/fixtures/dense.sa --runs 1 --quiet {line}"
        ));
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{line}");
        assert!(outcome.err.contains(reason), "{}", outcome.err);
    }
}

#[test]
fn invalid_command_lines_are_reported() {
    for line in [
        "trade",
        "trade tests/fixtures/dense.sa --tries 10",
        "trade tests/fixtures/dense.sa --time 0s",
        "trade tests/fixtures/dense.sa --time -1s",
        "trade tests/fixtures/dense.sa --runs 1",
        "trade tests/fixtures/dense.sa --until 5%",
        "trade tests/fixtures/dense.sa --dry-run --time 1m",
    ] {
        let outcome = stochc(line);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{line}");
    }
    let outcome = stochc("trade tests/fixtures/crowded.sa --runs 2");
    assert_eq!(outcome.status, 1);
    assert!(
        outcome.err.contains("400 free blocks do not fit"),
        "{}",
        outcome.err
    );
    let outcome = stochc("trade tests/fixtures/wrong.sa --runs 2");
    assert_eq!((outcome.status, outcome.out.as_str()), (1, ""));
}

#[test]
fn a_reduced_model_is_reported() {
    let line = "simulate tests/fixtures/dense.sa --runs 2 --substeps 2 --seed 2 --without friction --allow coarse-step";
    let outcome = stochc(line);
    assert_eq!(outcome.status, 0);
    let note = "note: runs without friction, which the scene has\n";
    assert!(outcome.err.starts_with(note), "{}", outcome.err);
}
