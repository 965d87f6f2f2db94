//! Tests ensembles without physics: the model `shuffle` makes one capture per tick.
use crate::stochc::{contains, path, stochc, stochc_with, tables};

const TOWER: &str = "simulate --model shuffle --quiet tests/fixtures/tower.sa";

#[test]
fn the_table_is_the_output() {
    let outcome = stochc("simulate --model shuffle --runs 5 tests/fixtures/tower.sa");
    assert_eq!(outcome.status, 0);
    assert!(
        outcome.err.starts_with("5 of 5 runs in "),
        "{}",
        outcome.err
    );
    insta::assert_snapshot!(outcome.out);
    let quiet = stochc_with(TOWER, &["--runs", "5"]);
    assert_eq!((quiet.status, quiet.err.as_str()), (0, ""));
    assert_eq!(quiet.out, outcome.out);
}

#[test]
fn programs_are_compared() {
    let outcome = stochc_with(TOWER, &["tests/fixtures/importing.sa", "--runs", "3"]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    insta::assert_snapshot!(outcome.out);
    // If a program is given twice, it counts as two programs.
    let outcome = stochc_with(TOWER, &["tests/fixtures/tower.sa", "--runs", "3"]);
    assert!(outcome.out.contains("tower (2)"), "{}", outcome.out);
}

/// Checks that a dry run prints the number of runs and their expected CPU time, and writes nothing.
#[test]
fn a_dry_run_forecasts_the_cpu_time() {
    let folder = tempfile::tempdir().unwrap();
    let out = crate::stochc::path(folder.path(), "out");
    let seconds = |line: &str, more: &[&str]| {
        let outcome = stochc_with(line, more);
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        assert!(outcome.out.contains(" of CPU time"), "{}", outcome.out);
        outcome.out
    };
    let sweep = "sweep --dry-run --quiet --substeps 1 examples/line.sa --out";
    let printed = seconds(sweep, &[&out, "--runs", "40", "--vary", "free=200,300"]);
    assert!(printed.starts_with("80 runs, "), "{printed}");
    assert!(!std::path::Path::new(&out).exists());
    // Nor does it calibrate.
    let sweep = "sweep --dry-run --model rate tests/fixtures/dense.sa --vary free=10,12";
    let outcome = stochc(sweep);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let note = "2 scenes have no rates. Calibrating each takes about 30 s of CPU time, which the forecast excludes";
    assert!(outcome.err.contains(note), "{}", outcome.err);
    let trade =
        "trade --dry-run --quiet --runs 2 --finest 2 --max-ticks 100 tests/fixtures/dense.sa";
    let printed = seconds(trade, &[]);
    assert!(printed.contains(" runs, "), "{printed}");
}

#[test]
fn results_are_available_as_json() {
    let figures = stochc_with(TOWER, &["--runs", "4", "--json"]).json();
    assert_eq!(figures["programs"][0]["completed"], 4);
    assert_eq!(figures["programs"][0]["time"]["mean"], 3.0);
    let both = stochc_with(TOWER, &["--runs", "4", "--json", "--captures"]).json();
    assert_eq!(both["programs"], figures["programs"]);
    let captures = &both["captures"][0];
    assert_eq!(captures["program"], "tower");
    assert_eq!(captures["captures"].as_array().unwrap().len(), 3);
}

#[test]
fn captures_are_printed_on_request() {
    let outcome = stochc_with(TOWER, &["--runs", "4", "--captures"]);
    let (_, captures) = outcome
        .out
        .split_once("tower, capture by capture\n")
        .unwrap();
    for edge in ["foot: M.up -> A", "top: A.up -> B", "top: B.up -> C"] {
        assert!(captures.contains(edge), "{captures}");
    }
}

#[test]
fn a_timeout_is_reported_with_its_status() {
    let outcome = stochc("simulate --model shuffle --runs 3 tests/fixtures/late.sa");
    assert_eq!(outcome.status, 3);
    let expected = "3 of 3 runs, 3 stopped in ";
    assert!(outcome.err.starts_with(expected), "{}", outcome.err);
    assert_eq!(outcome.row("Timed out"), ["3"]);
    let mean = outcome.row("Mean time").join(" ");
    assert_eq!(mean, "≥ 2, to 2");
    assert_eq!(outcome.row("  in seconds").join(" "), "≥ 40.0 ms");
    assert_eq!(outcome.row("SD (CV)"), ["-"], "unknown");
    assert!(outcome.out.contains("≥ marks a lower bound"));
    // The limit of the command has the same exit status as a timeout in the program.
    let outcome = stochc_with(TOWER, &["--runs", "3", "--max-ticks", "2"]);
    assert_eq!(outcome.status, 3);
    assert!(!outcome.out.contains("Timed out"), "{}", outcome.out);
    assert_eq!(outcome.row("Censored"), ["3"]);
}

#[test]
fn a_stopped_run_reports_its_limit_and_its_wait() {
    const LATE: &str = "trace --model shuffle --run 0 tests/fixtures/late.sa";
    for (limit, end) in [
        ("9", "timed out in phase grow after 2 ticks (40.0 ms)"),
        (
            "1",
            "stopped by `--max-ticks` in phase grow after 1 tick (20.0 ms)",
        ),
    ] {
        let outcome = stochc_with(LATE, &["--max-ticks", limit]);
        assert_eq!(outcome.status, 3);
        assert!(outcome.out.contains(end), "{}", outcome.out);
        assert!(
            outcome.out.contains("1 capture still waiting"),
            "{}",
            outcome.out
        );
    }
    let outcome = stochc(LATE);
    let wait =
        "tick       2  40.0 ms  T[2].up still waits for T[3] after 0 ticks (0 s) and 0 entries\n";
    assert!(outcome.out.contains(wait), "{}", outcome.out);
}

#[test]
fn a_trace_has_the_dockings_of_dead_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "dead.sa");
    let text = "scene worn from hemisphere { faults { dead 100% } }
        assembly a in worn { seed plate 1 x 1 { M at (0, 0) }
            phase grow timeout 20 ticks { M.up -> A } }";
    std::fs::write(&file, text).unwrap();
    let outcome = stochc_with("trace --model shuffle --run 0", &[&file]);
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    let docked = "  a dead block docks as A: block ";
    assert!(outcome.out.contains(docked), "{}", outcome.out);
    let outcome = stochc_with("simulate --model shuffle --runs 4 --quiet", &[&file]);
    assert_eq!(outcome.row("With dead blocks"), ["4"]);
    let estimate = stochc_with("estimate", &[&file]);
    let reason = "the estimate ignores the `faults` of the scene";
    assert!(estimate.out.contains(reason), "{}", estimate.out);
}

/// Checks that the record of a run can be understood without another file.
#[test]
fn a_run_in_json_has_names_and_indices() {
    let outcome = stochc("trace --model shuffle --run 0 --json tests/fixtures/late.sa");
    let record = &outcome.json()["runs"][0];
    assert_eq!(record["program"], "late");
    assert_eq!(record["phase_names"], serde_json::json!(["grow"]));
    assert_eq!(
        (&record["tick"], &record["seconds"]),
        (&0.02.into(), &0.04.into())
    );
    let outcome = serde_json::json!(
        { "kind": "timed_out", "phase": 0, "phase_name": "grow", "by": "timeout" }
    );
    assert_eq!(record["outcome"], outcome);
    let wait = &record["waiting"][0];
    assert_eq!(
        [
            &wait["phase_name"],
            &wait["parent_name"],
            &wait["child_name"]
        ],
        ["grow", "T[2]", "T[3]"]
    );
    let outcome = stochc("trace --model shuffle --run 0 --json tests/fixtures/attached.sa");
    for record in outcome.json()["runs"].as_array().unwrap() {
        assert_eq!(record["bonds"][0]["phase_name"], "seed");
        let release = &record["releases"][0];
        assert_eq!(
            [
                &release["phase_name"],
                &release["parent_name"],
                &release["child_name"]
            ],
            ["move", "A", "B"]
        );
        let unplanned = record["unplanned_bonds"].as_array();
        let unplanned = unplanned.map_or(0, Vec::len);
        assert_eq!(record["unplanned"].as_u64().unwrap_or(0), unplanned as u64);
    }
}

#[test]
fn results_do_not_depend_on_threads() {
    let folder = tempfile::tempdir().unwrap();
    let [one, four] = ["1", "4"].map(|threads| {
        let out = path(folder.path(), threads);
        let outcome = stochc_with(
            TOWER,
            &[
                "tests/fixtures/importing.sa",
                "--threads",
                threads,
                "--out",
                &out,
            ],
        );
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        (tables(&out), outcome.out)
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
fn trace_repeats_a_run_of_the_ensemble() {
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
        let trace = TOWER.replace("simulate", "trace");
        let outcome = stochc_with(&trace, &["--seed", "7", "--json", "--run", &run]);
        assert!(
            contains(&outcome.json()["runs"][0], &record),
            "run {run}: {}",
            outcome.out
        );
    }
}

#[test]
fn trace_prints_every_capture() {
    let outcome = stochc("trace --model shuffle --run 1 tests/fixtures/tower.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    let printed = without_blocks(&outcome.out);
    insta::assert_snapshot!(printed);
}

/// Returns the text with `N` in place of the random numbers of blocks.
fn without_blocks(text: &str) -> String {
    let line = |line: &str| match line.split_once(": block ") {
        Some((before, _)) => format!("{before}: block N\n"),
        None => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

/// Checks that the required precision determines the number of runs, reproducibly.
#[test]
fn runs_are_made_until_means_are_known() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let line = "simulate examples/line.sa examples/open_platform.sa --model rate --quiet --json";
    let until = |share: &str| {
        let shown = stochc_with(line, &["--until", share, "--out", &out]);
        assert_eq!(shown.status, 0, "{}", shown.err);
        (shown.json(), shown.err)
    };
    let relative = |shown: &serde_json::Value| -> Vec<f64> {
        let programs = shown["programs"].as_array().unwrap();
        let half = |it: &serde_json::Value| {
            let [half, mean] = ["half_width", "mean"].map(|key| it["time"][key].as_f64().unwrap());
            half / mean
        };
        programs.iter().map(half).collect()
    };
    let (shown, err) = until("3%");
    let runs = shown["programs"][0]["runs"].as_u64().unwrap();
    assert!(relative(&shown).iter().all(|&half| half <= 0.03), "{shown}");
    assert!((60..400).contains(&runs) && err.is_empty(), "{runs}: {err}");
    // The same runs result if their number is given directly.
    let at_once = path(folder.path(), "at_once");
    let requested = stochc_with(line, &["--runs", &runs.to_string(), "--out", &at_once]).json();
    assert_eq!(requested, shown);
    // Repeating the command finds the finished runs. A smaller interval requires `resume`.
    assert_eq!(until("3%").0, shown);
    let tighter = stochc_with(line, &["--until", "2%", "--out", &out]);
    assert_eq!(tighter.status, 2, "{}", tighter.err);
    // Resuming makes more runs, up to the limit.
    let further = stochc_with("resume --quiet --json --until 2%", &[&out]).json();
    assert!(further["programs"][0]["runs"].as_u64().unwrap() > runs);
    let other = path(folder.path(), "other");
    let few = stochc_with(line, &["--until", "2%", "--runs", "40", "--out", &other]);
    assert_eq!(few.status, 0);
    assert!(
        few.err.contains("not every mean is known to within 2 %"),
        "{}",
        few.err
    );
    assert_eq!(few.json()["programs"][0]["runs"], 40);
    // A program that never completes does not delay the others, and the command reports it.
    let never = path(folder.path(), "never.sa");
    let program = "assembly never { seed plate 3 x 3 { M at (1, 1) } phase grow timeout 5 ticks { M.up -> A } }";
    std::fs::write(&never, program).unwrap();
    let out = path(folder.path(), "endless");
    let endless = ["--model", "rate", "--until", "5%", "--quiet", "--out", &out];
    let outcome = stochc_with("simulate", &[&[never.as_str()], &endless[..]].concat());
    assert_eq!(outcome.status, 3);
    let expected = "not every mean is known to within 5 %: never (0 completed)";
    assert!(outcome.err.contains(expected), "{}", outcome.err);
    assert_eq!(
        stochc_with(line, &["--until", "3%"]).status,
        2,
        "it needs a folder"
    );
}
