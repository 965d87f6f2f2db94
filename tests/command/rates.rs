//! Rates of scenes: measured, kept, simulated by, and estimated with.
use std::fs;

use serde_json::Value;

use crate::stochc::{path, stochc, stochc_with};

/// A small, crowded scene in which blocks dock soon, and a program in it.
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
fn rates_are_measured_kept_and_used() {
    let folder = tempfile::tempdir().unwrap();
    let here = |name: &str| path(folder.path(), name);
    fs::write(here("small.sa"), SMALL).unwrap();
    let calibrate = "calibrate --runs 1 --max-ticks 3000 --quiet --seed 3";
    let first = stochc_with(
        &format!("{calibrate} --threads 1"),
        &[&here("small.sa"), "--out", &here("one.rates")],
    );
    assert_eq!(first.status, 0, "{}", first.err);
    assert!(first.out.contains("mean wait, ticks"), "{}", first.out);
    // However many threads make the runs, the rates are the same.
    let second = stochc_with(
        &format!("{calibrate} --threads 2"),
        &[&here("small.sa"), "--out", &here("two.rates")],
    );
    assert_eq!((second.status, &second.out), (0, &first.out));
    let kept = fs::read(here("one.rates")).unwrap();
    assert_eq!(kept, fs::read(here("two.rates")).unwrap());
    // What is there is not replaced.
    let again = stochc_with(calibrate, &[&here("small.sa"), "--out", &here("one.rates")]);
    assert_eq!(again.status, 2, "{}", again.err);
    assert_eq!(kept, fs::read(here("one.rates")).unwrap());

    let simulate = "simulate --model rate --runs 20 --quiet --format json";
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
    // The manifest holds the rates.
    let repeated = stochc_with(
        "simulate --quiet --format json --manifest",
        &[&here("runs/manifest.json")],
    );
    assert_eq!((repeated.status, repeated.out), (0, ensemble.out));
    // Rates of another scene are of no use, and say so.
    let line = "scene other from hemisphere { free 61 uniform }
        assembly line in other { seed plate 1 x 1 { M at (0, 0) } phase grow { M.up ->> T[1..3] } }";
    fs::write(here("other.sa"), line).unwrap();
    let spoilt = fs::read_to_string(here("one.rates"))
        .unwrap()
        .replace("\"format\": 1", "\"format\": 9");
    fs::write(here("spoilt.rates"), spoilt).unwrap();
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
    assert!(few.err.contains("captures were observed"), "{}", few.err);
}

#[test]
fn the_line_takes_by_rates_what_it_takes_with_physics() {
    let said = stochc("simulate --model rate --runs 400 --quiet --format json examples/line.sa");
    assert_eq!(said.status, 0, "{}", said.err);
    let value: Value = serde_json::from_str(&said.out).unwrap();
    let mean = value["programs"][0]["time"]["mean"].as_f64().unwrap();
    // 8113 ± 190 with physics (docs/reproduction.md), and the bias that docs/rates.md admits.
    assert!((7500.0..8800.0).contains(&mean), "{mean}");
    let text = stochc("simulate --model rate --runs 5 --quiet examples/line.sa");
    assert!(text.out.contains("docs/rates.md"), "{}", text.out);
}

#[test]
fn estimates_say_when_and_why() {
    let said = stochc(
        "estimate --format json --quiet examples/line.sa examples/five_tower_reconfigured.sa",
    );
    assert_eq!(said.status, 0, "{}", said.err);
    let value: Value = serde_json::from_str(&said.out).unwrap();
    for estimate in value.as_array().unwrap() {
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
    // In a chain everybody is waited for.
    assert_eq!(value[0]["shares"].as_array().unwrap().len(), 13);
    let text = stochc("estimate --captures 2 --quiet examples/line.sa");
    assert!(
        text.out.contains("waited for") && text.out.contains("docs/rates.md"),
        "{}",
        text.out
    );
}

#[test]
fn nothing_is_recorded_of_blocks_that_have_no_places() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "runs");
    let said = stochc_with(
        "simulate --model rate --runs 2 --record 0 examples/line.sa --out",
        &[&out],
    );
    assert_eq!(said.status, 2);
    assert!(said.err.contains("`rate` has no places"), "{}", said.err);
    let tank = stochc("simulate --model rate --runs 2 --quiet examples/suction_growth.sa");
    assert_ne!(tank.status, 0);
    assert!(tank.err.contains("suction"), "{}", tank.err);
}
