//! Tests the search for the best parameters.
use std::fs;

use serde_json::Value;

use crate::stochc::{path, stochc_with};

const TOWERS: &str = "assembly towers(height = 3) {
    seed plate 3 x 1 { M at (0, 0)  N at (2, 0) }
    phase grow {
        M.up ->> A[1..height]
        N.up ->> B[1..height]
    }
}
";

/// Writes the program to a folder and returns its path.
fn towers(folder: &std::path::Path) -> String {
    let file = path(folder, "towers.sa");
    fs::write(&file, TOWERS).unwrap();
    file
}

#[test]
fn an_optimum_is_found_confirmed_and_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let (file, out) = (towers(folder.path()), path(folder.path(), "out"));
    let optimize = |more: &[&str]| {
        let command = "optimize --model rate --runs 64 --vary height=2..7 --quiet";
        let arguments = [&[&*file, "--out", &*out], more].concat();
        let outcome = stochc_with(command, &arguments);
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        outcome.out
    };
    let text = optimize(&[]);
    assert!(text.contains("at an end"), "{text}");
    let json = optimize(&["--json"]);
    assert_eq!(
        json,
        fs::read_to_string(path(out.as_ref(), "optimum.json")).unwrap()
    );
    let document: Value = serde_json::from_str(&json).unwrap();
    let optimum = &document["optima"][0];
    let height = &optimum["numbers"][0];
    assert_eq!(
        (&height["value"], &height["similar"]["name"]),
        (&2.0.into(), &"height".into())
    );
    // Most of the waiting time is in proportion to the height.
    let elasticity = height["elasticity"]["value"].as_f64().unwrap();
    assert!((0.4..1.2).contains(&elasticity), "{elasticity}");
    let bound = |of: &str, key: &str| optimum[of][key].as_f64().unwrap();
    assert!(bound("predicted", "low") < bound("confirmed", "high"));
    assert!(bound("confirmed", "low") < bound("predicted", "high"));
    // Missing runs are made again, and the result is the same.
    for lost in ["confirmation", "round-2"] {
        fs::remove_dir_all(path(out.as_ref(), lost)).unwrap();
        assert_eq!(optimize(&["--json"]), json, "{lost}");
    }
}

#[test]
fn stopped_runs_of_the_confirmation_have_an_exit_status() {
    let folder = tempfile::tempdir().unwrap();
    let file = towers(folder.path());
    let command = "optimize --model rate --runs 40 --vary height=2..7 --max-ticks 1500 --quiet";
    let outcome = stochc_with(command, &[&file]);
    assert_eq!(outcome.status, 3, "{}", outcome.err);
    for what in ["of the search", "with another seed"] {
        let note = format!("runs {what} did not complete");
        assert!(outcome.out.contains(&note), "{}", outcome.out);
    }
}

#[test]
fn constraints_are_confirmed() {
    let folder = tempfile::tempdir().unwrap();
    let file = towers(folder.path());
    let optimize = |constraint: &str, more: &str| {
        let command = format!(
            "optimize --model rate --runs 40 --confirm 100 --vary height=2..7 --quiet {more} --subject-to"
        );
        stochc_with(&command, &[constraint, &file])
    };
    // A run takes about 2000 ticks.
    let possible = optimize("P(T>20000)<=0.1", "--subject-to mean<=9000 --json");
    assert_eq!(possible.status, 0, "{}", possible.err);
    let optimum = &possible.json()["optima"][0];
    assert_eq!(optimum["feasible"], true);
    let [mean, probability] = [0, 1].map(|i| &optimum["constraints"][i]);
    assert_eq!(mean["constraint"], "mean <= 9000");
    assert_eq!(mean["verdict"], "holds");
    assert_eq!(mean["confirmed"], optimum["confirmed"]);
    assert_eq!(probability["constraint"], "P(T > 20000) <= 0.1");
    assert_eq!(probability["confirmed"]["value"], 0.0);
    assert_eq!(probability["verdict"], "holds");
    let impossible = optimize("mean <= 90", "");
    assert_eq!(impossible.status, 3, "{}", impossible.err);
    for part in ["towers: mean <= 90", "fails", "comes nearest"] {
        assert!(impossible.out.contains(part), "{}", impossible.out);
    }
}

/// Checks that the forecast does not calibrate the scene of any point.
#[test]
fn a_dry_run_simulates_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let file = towers(folder.path());
    let outcome = stochc_with(
        "optimize --dry-run --model rate --vary free=100..500",
        &[&file],
    );
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(outcome.out.contains(" of CPU time"), "{}", outcome.out);
    let note = "Calibrating each takes about 30 s of CPU time, which the forecast excludes";
    assert!(outcome.err.contains(note), "{}", outcome.err);
}

#[test]
fn other_options_do_not_continue_an_optimization() {
    let folder = tempfile::tempdir().unwrap();
    let (file, out) = (towers(folder.path()), path(folder.path(), "out"));
    let optimize = |range: &str| {
        let command = "optimize --model rate --runs 40 --confirm 10 --quiet --vary";
        stochc_with(command, &[range, &file, "--out", &out])
    };
    let first = optimize("height=2..7");
    assert_eq!(first.status, 0, "{}", first.err);
    let other = optimize("height=2..6");
    assert_eq!((other.status, other.out.as_str()), (2, ""), "{}", other.err);
}

#[test]
fn wrong_options_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let file = towers(folder.path());
    let error = |options: &str| {
        let command = format!("optimize --model rate --quiet {options}");
        let outcome = stochc_with(&command, &[&file]);
        assert_eq!((outcome.status, outcome.out.as_str()), (2, ""), "{options}");
        outcome.err
    };
    for (options, reason) in [
        ("--vary hight=2..7", "did you mean `height`?"),
        ("--vary height=2..7/3", "NAME=FROM..TO"),
        ("--vary height=2..4", "at least five values"),
        ("--vary height=2..7 --vary height=2..6", "is given twice"),
        ("--vary height=2..7 --set height=3", "height"),
        (
            "--vary height=2..7 --runs 19",
            "1 parameters need at least 20 runs",
        ),
        ("--vary height=2..7 --minimize median", "write `mean`"),
        (
            "--vary height=2..7 --minimize P(T>9) --max-ticks 9",
            "shorter than `--max-ticks`",
        ),
        (
            "--vary height=2..7 --subject-to p90<=9 --max-ticks 9",
            "--subject-to: the time must be shorter than `--max-ticks`",
        ),
        (
            "--vary height=2..7 --subject-to p90",
            "write `mean <= 5000`",
        ),
    ] {
        let message = error(options);
        assert!(message.contains(reason), "{options}: {message}");
    }
    let message = stochc_with("optimize --quiet --vary", &["tick=10..20 ms", &file]).err;
    assert!(message.contains("cannot be optimized"), "{message}");
}
