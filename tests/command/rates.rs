//! Tests rates of scenes: how they are calibrated, stored and used for simulations and estimates.
use std::fs;

use serde_json::Value;
use stochc_estimate::Interaction;

use crate::stochc::{Outcome, path, stochc, stochc_with};

/// Source of a program in a small, crowded scene, whose captures are fast.
const SMALL: &str = "scene small from hemisphere {
    free 60 uniform
    enclosure hemisphere { radius 2.4m  wall 250 N/m }
}
assembly tower in small {
    seed plate 3 x 3 { M at (1, 1) }
    phase grow { M.up ->> T[1..3] }
}
";

#[test]
fn rates_are_calibrated_saved_and_used() {
    let folder = tempfile::tempdir().unwrap();
    let here = |name: &str| path(folder.path(), name);
    fs::write(here("small.sa"), SMALL).unwrap();
    let calibrate = "calibrate --runs 1 --max-ticks 3000 --quiet --seed 3";
    let first = stochc_with(
        &format!("{calibrate} --threads 1"),
        &[&here("small.sa"), "--out", &here("one.rates")],
    );
    assert_eq!(first.status, 0, "{}", first.err);
    assert!(
        first.out.contains("waiting time at an open face"),
        "{}",
        first.out
    );
    // The calibrated rates do not depend on the number of threads.
    let second = stochc_with(
        &format!("{calibrate} --threads 2"),
        &[&here("small.sa"), "--out", &here("two.rates")],
    );
    assert_eq!((second.status, &second.out), (0, &first.out));
    let saved = fs::read(here("one.rates")).unwrap();
    assert_eq!(saved, fs::read(here("two.rates")).unwrap());
    // Existing files are not replaced.
    let again = stochc_with(calibrate, &[&here("small.sa"), "--out", &here("one.rates")]);
    assert_eq!(again.status, 2, "{}", again.err);
    assert_eq!(saved, fs::read(here("one.rates")).unwrap());

    let simulate = "simulate --model rate --runs 20 --quiet --json";
    let ensemble = stochc_with(
        simulate,
        &[
            &here("small.sa"),
            "--rates",
            &here("one.rates"),
            "--out",
            &here("runs"),
        ],
    );
    assert_eq!(ensemble.status, 0, "{}", ensemble.err);
    // The manifest contains the rates.
    let repeated = stochc_with("repeat --quiet --json", &[&here("runs/manifest.json")]);
    assert_eq!((repeated.status, repeated.out), (0, ensemble.out));
    // The results folder also contains the rates, so resumed runs use them.
    let resumed = stochc_with("resume --runs 30 --quiet", &[&here("runs")]);
    assert_eq!((resumed.status, resumed.err.as_str()), (0, ""));
    // Rates of another scene are not used, and the command reports this. The scene then has an
    // uncalibrated estimate, so no calibration is needed.
    let line = "scene other from hemisphere { free 200 uniform }
        assembly line in other { seed plate 1 x 1 { M at (0, 0) } phase grow { M.up ->> T[1..3] } }";
    fs::write(here("other.sa"), line).unwrap();
    let unused = format!("`{}` is not used", here("one.rates"));
    for command in ["estimate --quiet", "check --cost=5"] {
        for (file, is_unused) in [("other.sa", true), ("small.sa", false)] {
            let outcome = stochc_with(command, &[&here(file), "--rates", &here("one.rates")]);
            assert_eq!(outcome.status, 0, "{}", outcome.err);
            // The message is printed only once.
            let times = outcome.err.matches(&unused).count();
            assert_eq!(times, usize::from(is_unused), "{command}: {}", outcome.err);
        }
    }
    let corrupted = fs::read_to_string(here("one.rates"))
        .unwrap()
        .replace("\"format\": ", "\"format\": 9");
    fs::write(here("spoilt.rates"), corrupted).unwrap();
    let refused = stochc_with(
        simulate,
        &[&here("small.sa"), "--rates", &here("spoilt.rates")],
    );
    assert_eq!(refused.status, 2);
    assert!(refused.err.contains("calibrate again"), "{}", refused.err);
    let few = stochc_with(
        "calibrate --runs 1 --max-ticks 5 --quiet",
        &[&here("other.sa")],
    );
    assert_eq!(few.status, 3, "{}", few.err);
    let reason = "no block was captured in 25 calibration runs; calibrate with a larger";
    assert!(few.err.contains(reason), "{}", few.err);
}

#[test]
fn the_rate_model_agrees_with_physics_for_the_line() {
    let outcome = stochc("simulate --model rate --runs 400 --quiet --json examples/line.sa");
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let value: Value = serde_json::from_str(&outcome.out).unwrap();
    let mean = value["programs"][0]["time"]["mean"].as_f64().unwrap();
    // Simulations give 8113 ± 190 (docs/validation/paper.md). docs/validation/rates.md describes
    // the bias.
    assert!((7500.0..8800.0).contains(&mean), "{mean}");
    let text = stochc("simulate --model rate --runs 5 --quiet examples/line.sa");
    assert!(
        text.out.contains("docs/validation/rates.md"),
        "{}",
        text.out
    );
}

#[test]
fn estimates_name_the_critical_captures() {
    let outcome =
        stochc("estimate --json --quiet examples/line.sa examples/five_tower_reconfigured.sa");
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let value: Value = serde_json::from_str(&outcome.out).unwrap();
    for estimate in value["estimates"].as_array().unwrap() {
        let total = &estimate["total"];
        let figure = |name: &str| total[name].as_f64().unwrap();
        assert!(figure("p10") < figure("median") && figure("median") < figure("p90"));
        let phases = estimate["phases"].as_array().unwrap();
        let sum: f64 = phases
            .iter()
            .map(|phase| phase["times"]["mean"].as_f64().unwrap())
            .sum();
        assert!(
            (sum / figure("mean") - 1.0).abs() < 1e-9,
            "phases add up: {sum}"
        );
        let shares = estimate["shares"].as_array().unwrap();
        let sum: f64 = shares
            .iter()
            .map(|share| share["share"].as_f64().unwrap())
            .sum();
        assert!(sum <= 1.0 + 1e-9 && sum > 0.98, "{sum}");
    }
    // In a chain of captures, every capture is on the critical path.
    assert_eq!(
        value["estimates"][0]["shares"].as_array().unwrap().len(),
        13
    );
    let method = |number: usize| &value["estimates"][number]["method"];
    assert_eq!(
        (&method(0)["kind"], &method(0)["interaction"]),
        (&"graph".into(), &"apart".into())
    );
    assert_eq!(method(1)["interaction"], "releases");
    for (number, interaction) in [(0, Interaction::Apart), (1, Interaction::Releases)] {
        assert_eq!(method(number)["error"], interaction.error());
    }
    let (status, message) = crate::plan::wrong("estimate --max-ticks 10 examples/line.sa", &[]);
    assert_eq!((status, message.contains("--runs")), (2, true), "{message}");
    let text = stochc("estimate --captures=2 --quiet examples/line.sa");
    assert!(
        text.out.contains("waiting for this capture only")
            && text.out.contains("docs/validation/rates.md"),
        "{}",
        text.out
    );
    assert!(
        text.out.contains(" samples of the dependency graph."),
        "{}",
        text.out
    );
}

#[test]
fn estimates_sample_runs_if_requested_or_needed() {
    let mean = |outcome: &Outcome| {
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        let value: Value = serde_json::from_str(&outcome.out).unwrap();
        let estimate = value["estimates"][0].clone();
        (estimate["total"]["mean"].as_f64().unwrap(), estimate)
    };
    let folder = tempfile::tempdir().unwrap();
    let compiled = path(folder.path(), "line.json");
    let outcome = stochc_with(
        "compile --emit executable examples/line.sa --out",
        &[&compiled],
    );
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let (drawn, _) = mean(&stochc("estimate --json --quiet examples/line.sa"));
    let (run, of_runs) = mean(&stochc(
        "estimate --runs 400 --json --quiet examples/line.sa",
    ));
    assert_eq!(of_runs["completed"], 400);
    // The standard deviation of a run is a fifth of its mean.
    assert!(
        (drawn / run - 1.0).abs() < 4.0 * 0.2 / 20.0,
        "{drawn} {run}"
    );
    // A compiled file contains the dependency graph of its program.
    let of_compiled = mean(&stochc_with("estimate --json --quiet", &[&compiled]));
    assert_eq!(
        (of_compiled.0, &of_compiled.1["method"]["kind"]),
        (drawn, &"graph".into())
    );
}

/// Checks a program that times out in its first phase in a third of all runs. The graph, runs by
/// rates, and `simulate` agree.
#[test]
fn a_program_that_times_out_is_the_slowest() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "a.sa");
    let text = "assembly a { seed plate 1 x 1 { M at (0, 0) }
        phase first timeout 800 ticks { M.up -> A } phase second { A.up -> B } }";
    fs::write(&file, text).unwrap();
    let estimated = |more: &str| {
        let command = format!("estimate --quiet --json {more}");
        let outcome = stochc_with(command.trim(), &[&file]);
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        outcome.json()["estimates"][0].clone()
    };
    let [graph, runs] = ["", "--runs 1000"].map(estimated);
    let command = "simulate --quiet --model rate --runs 1000 --json";
    let simulated = stochc_with(command, &[&file]).json();
    let simulated = simulated["programs"][0]["time"]["median"].as_f64().unwrap();
    for it in [&graph, &runs] {
        let (completed, stopped) = (it["completed"].as_f64(), it["incomplete"].as_f64());
        let stopped = stopped.unwrap() / (completed.unwrap() + stopped.unwrap());
        assert!((0.2..0.45).contains(&stopped), "{stopped}");
        let total = &it["total"];
        assert!(total["mean"].is_null() && total["p90"].is_null(), "{total}");
        let median = total["median"].as_f64().unwrap();
        // Each value has a standard error of about 3 %.
        assert!(
            (median / simulated - 1.0).abs() < 0.12,
            "{median} and {simulated}"
        );
        let [first, second] = [0, 1].map(|phase| &it["phases"][phase]["times"]);
        assert!(first["mean"].is_null(), "{first}");
        assert!(second["mean"].as_f64().is_some(), "{second}");
    }
    let [graph, runs] = [graph, runs].map(|it| it["total"]["p10"].as_f64().unwrap());
    assert!((graph / runs - 1.0).abs() < 0.15, "{graph} and {runs}");
    let text = stochc_with("estimate --quiet", &[&file]).out;
    assert!(text.contains("the slowest"), "{text}");
    // Runs are stopped before the end of the second phase, so its quantiles are unknown.
    let cut = estimated("--runs 1000 --max-ticks 1500");
    assert!(cut["phases"][1]["times"].is_null(), "{cut}");
    assert!(cut["total"]["p10"].as_f64().is_some(), "{cut}");
}

#[test]
fn uncalibrated_scenes_are_estimated_and_marked() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "small.sa");
    fs::write(&file, SMALL).unwrap();
    let outcome = stochc_with("estimate --quiet --json", &[&file]);
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    let value: Value = serde_json::from_str(&outcome.out).unwrap();
    assert_eq!(value["estimates"][0]["method"]["is_first_guess"], true);
    let text = stochc_with("estimate --quiet examples/line.sa", &[&file]);
    let words = text.out.split_whitespace().collect::<Vec<_>>().join(" ");
    for what in ["uncalibrated estimate", "by a factor of", "by 3 %"] {
        assert!(words.contains(what), "{what}: {}", text.out);
    }
}

/// Scenes whose rates need a held-out error.
const NEED_RATES: [&str; 5] = [
    "examples/experiment_1.sa",
    "examples/experiment_3.sa",
    "examples/microns.sa",
    "examples/lab/air_table.sa",
    "HEAVY",
];

/// Commands that use rates, without options.
const BY_RATES: [&str; 3] = [
    "estimate --quiet",
    "estimate --runs 2 --quiet",
    "simulate --model rate --runs 2 --quiet",
];

#[test]
fn scenes_that_need_a_held_out_error_need_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let heavy = path(folder.path(), "heavy.sa");
    let text = SMALL.replace("free 60 uniform", "free 60 uniform  gravity 1 m/s^2");
    fs::write(&heavy, text).unwrap();
    for file in NEED_RATES {
        let file = if file == "HEAVY" { &heavy } else { file };
        for command in BY_RATES {
            let outcome = stochc_with(command, &[file]);
            assert_eq!((outcome.status, outcome.out.as_str()), (1, ""), "{command}");
            let reason = "this scene has no calibrated rates; run `stochc calibrate`";
            let err = &outcome.err;
            assert!(err.contains(reason), "{command} {file}: {err}");
        }
        let cost = stochc_with("check --cost --allow warnings", &[file]);
        assert_eq!(cost.status, 0, "{}", cost.err);
        assert!(!cost.out.contains("in ticks"), "{file}: {}", cost.out);
        let reason = "No times: this scene has no calibrated rates";
        assert!(cost.out.contains(reason), "{file}: {}", cost.out);
    }
    for command in BY_RATES {
        let outcome = stochc_with(command, &["examples/experiment_2.sa"]);
        assert_eq!((outcome.status, outcome.out.as_str()), (1, ""), "{command}");
        let reason = "the model `rate` does not support aggregate; use `--model rigid`";
        assert!(outcome.err.contains(reason), "{command}: {}", outcome.err);
    }
}

/// Calibrates a planar scene. Commands use its rates, or refuse them if their held-out error is too
/// large.
#[test]
fn rates_with_a_large_held_out_error_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let here = |name: &str| path(folder.path(), name);
    let file = "examples/lab/air_table.sa";
    let calibrated = stochc_with(
        "calibrate --runs 3 --max-ticks 3000 --quiet --seed 3",
        &[file, "--out", &here("measured.rates")],
    );
    let (status, out) = (calibrated.status, &calibrated.out);
    assert!(matches!(status, 0 | 3), "{}", calibrated.err);
    assert!(
        out.contains("held-out error of mean waiting times"),
        "{out}"
    );
    let measured = fs::read(here("measured.rates")).unwrap();
    let mut rates: Value = serde_json::from_slice(&measured).unwrap();
    assert!(rates["held_out"]["sampling"].as_f64().unwrap() < 0.6);
    let mut write = |name: &str, error: Value| {
        rates["held_out"]["error"] = error;
        fs::write(here(name), rates.to_string()).unwrap();
    };
    write("accurate.rates", 0.15.into());
    write("inaccurate.rates", 0.286.into());
    write("invalid.rates", Value::Null);
    for command in BY_RATES.into_iter().chain(["check --cost"]) {
        let with = |rates: &str| stochc_with(command, &[file, "--rates", &here(rates)]);
        let accurate = with("accurate.rates");
        assert_eq!(accurate.status, 0, "{command}: {}", accurate.err);
        assert!(
            accurate.out.contains("ticks"),
            "{command}: {}",
            accurate.out
        );
        let inaccurate = with("inaccurate.rates");
        let reason = "the rates of this scene have a held-out error of 28.6 %";
        let err = &inaccurate.err;
        assert_eq!(
            (inaccurate.status, inaccurate.out.as_str()),
            (2, ""),
            "{command}"
        );
        assert!(
            err.contains(reason) && err.contains("rigid"),
            "{command}: {err}"
        );
        assert_eq!(with("invalid.rates").status, 2, "{command}");
    }
    // The rate model would decide this claim.
    let claim = "expect complete within 1 ticks with probability <= 0.5\n}";
    let text = fs::read_to_string(file).unwrap().trim_end().to_owned();
    let text = format!("{}{claim}", text.strip_suffix('}').unwrap());
    fs::write(here("claim.sa"), text).unwrap();
    let tested = stochc_with(
        "test --json --quiet --runs 40 --max-ticks 5 --rates",
        &[&here("accurate.rates"), &here("claim.sa")],
    );
    assert_eq!(tested.status, 0, "{}", tested.err);
    assert_eq!(tested.json()["claims"][0]["model"], "rigid");
}

/// All runs fail at their start.
#[test]
fn a_calibration_without_captures_ends() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "wild.sa");
    let physics = "free 40 uniform  gravity 1 m/s^2  agitation kicks { speed 0 .. 1e30 m/s }";
    let body = "seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> T }";
    let text =
        format!("scene wild from hemisphere {{ {physics} }} assembly a in wild {{ {body} }}");
    fs::write(&file, text).unwrap();
    let outcome = stochc_with("calibrate --quiet --allow warnings", &[&file]);
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    let (failed, err) = (" calibration runs failed (", &outcome.err);
    assert!(err.contains(failed), "{err}");
    assert!(!err.contains("`--runs`"), "{err}");
}

#[test]
fn models_without_positions_are_not_recorded() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "runs");
    let outcome = stochc_with(
        "simulate --model rate --runs 2 --record 0 examples/line.sa --out",
        &[&out],
    );
    assert_eq!(outcome.status, 2);
    assert!(
        outcome
            .err
            .contains("blocks have no positions in the model `rate`"),
        "{}",
        outcome.err
    );
    let tank = stochc("simulate --model rate --runs 2 --quiet examples/suction_growth.sa");
    assert_ne!(tank.status, 0);
    assert!(tank.err.contains("no calibrated rates"), "{}", tank.err);
}

/// Checks that both commands print the same mean and interval for the same few runs.
#[test]
fn a_sampled_estimate_has_the_interval_of_an_ensemble() {
    let line = "--runs 5 --seed 3 --quiet --json";
    let runs = stochc(&format!("simulate examples/line.sa --model rate {line}")).json();
    let estimate = stochc(&format!("estimate examples/line.sa {line}")).json();
    let (time, total) = (
        &runs["programs"][0]["time"],
        &estimate["estimates"][0]["total"],
    );
    for figure in ["mean", "half_width"] {
        let [known, found] = [time, total].map(|of| of[figure].as_f64().unwrap());
        assert!(
            (found / known - 1.0).abs() < 1e-9,
            "{figure}: {found} {known}"
        );
    }
}
