//! Tests parameters of assemblies and the option `--set`.
use std::fs;

use serde_json::Value;

use crate::stochc::{path, stochc_with};

const POSTS: &str = "assembly posts(height = 3, count = height - 1) {
    seed plate 2 * count - 1 x 1 {
        for i in 1..count { S[i] at (2 * (i - 1), 0) }
    }
    phase grow {
        for i in 1..count { S[i].up ->> T[i, 1..height] }
    }
}
";

/// Runs a command on the program. Returns its status, output and messages.
fn posts(command: &str, options: &[&str]) -> (i32, String, String) {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "posts.sa");
    fs::write(&file, POSTS).unwrap();
    let mut arguments = vec![file.as_str()];
    arguments.extend(options);
    let outcome = stochc_with(command, &arguments);
    let shown = |text: &str| text.replace(&file, "posts.sa");
    (outcome.status, shown(&outcome.out), shown(&outcome.err))
}

#[test]
fn defaults_are_expressions_that_set_values_replace() {
    let captures = |options: &[&str]| {
        let (status, out, err) = posts("check", options);
        assert_eq!((status, err.as_str()), (0, ""), "{options:?}");
        out.lines().next().unwrap().to_owned()
    };
    assert!(captures(&[]).contains("6 captures"));
    // The default of `count` follows the new height.
    assert!(captures(&["--set", "height=5"]).contains("20 captures"));
    assert!(captures(&["--set", "height=5", "--set", "count=1"]).contains("5 captures"));
    let (_, tables, _) = posts("compile", &["--set", "count=1"]);
    insta::assert_snapshot!(tables);
}

#[test]
fn unknown_and_invalid_values_are_reported() {
    let error = |value: &str| {
        let (status, out, err) = posts("check", &["--set", value]);
        assert_eq!((status, out.as_str()), (2, ""), "{value}");
        err
    };
    insta::assert_snapshot!(
        [
            "hight=4",
            "faults.dead=1%",
            "gravitty=1",
            "height=2.5",
            "height=4 cm",
            "height=1,2",
            "height",
            "bond.pull=3 s"
        ]
        .map(error)
        .join("\n")
    );
}

#[test]
fn a_value_that_breaks_the_program_is_reported_in_its_place() {
    let (status, _, err) = posts("check", &["--set", "count=0"]);
    assert_eq!(status, 1);
    insta::assert_snapshot!(err);
}

#[test]
fn a_parameter_and_a_constant_of_the_assembly_have_different_names() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "twice.sa");
    let text = POSTS.replace("    phase", "    let height = 4\n    phase");
    fs::write(&file, text).unwrap();
    let outcome = stochc_with("check --format short", &[&file]);
    assert_eq!(outcome.status, 1);
    assert!(outcome.out.contains("duplicate-name"), "{}", outcome.out);
}

#[test]
fn a_sweep_varies_parameters_and_stores_them() {
    let folder = tempfile::tempdir().unwrap();
    let out = path(folder.path(), "out");
    let (status, _, err) = posts(
        "sweep --model shuffle --quiet --runs 2",
        &["--vary", "height=2..4/3", "--set", "count=1", "--out", &out],
    );
    assert_eq!((status, err.as_str()), (0, ""));
    let manifest = fs::read_to_string(folder.path().join("out/manifest.json")).unwrap();
    let manifest: Value = serde_json::from_str(&manifest).unwrap();
    let programs = manifest["programs"].as_array().unwrap();
    for (program, height) in programs.iter().zip(2..) {
        assert_eq!(program["name"], format!("posts [count=1, height={height}]"));
        assert_eq!(program["parameters"]["height"], height);
        assert_eq!(program["set"][0]["name"], "count");
    }
    assert_eq!(programs.len(), 3);
}

#[test]
fn a_parameter_has_one_value_or_is_swept() {
    let (status, _, err) = posts("check", &["--set", "height=2", "--set", "height=4"]);
    assert_eq!(
        (status, err.trim()),
        (2, "error: --set: `height` has two values")
    );
    for name in ["height", "bond.pull"] {
        let (value, range) = match name {
            "height" => ("4", "2,3"),
            _ => ("10 N", "10,20 N"),
        };
        let set = format!("{name}={value}");
        let vary = format!("{name}={range}");
        let options = ["--set", &set, "--vary", &vary];
        let (status, _, err) = posts("sweep --model shuffle --quiet --runs 2", &options);
        assert_eq!(status, 2, "{err}");
        assert!(
            err.contains(&format!("`{name}` is swept, and `--set`")),
            "{err}"
        );
    }
}

#[test]
fn a_program_parameter_hides_a_scene_parameter() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "ticks.sa");
    fs::write(&file, POSTS.replace("height", "tick")).unwrap();
    let check = |value: &str| stochc_with("check --json", &[&file, "--set", value]);
    let captures = |value: &str| {
        let outcome = check(value);
        assert_eq!((outcome.status, &*outcome.err), (0, ""), "{value}");
        let document: Value = serde_json::from_str(&outcome.out).unwrap();
        document["programs"][0]["captures"].as_u64().unwrap()
    };
    assert_eq!(captures("count=1"), 3);
    assert_eq!(captures("tick=5"), 20);
    // The diagnostics are printed even though the value is invalid.
    let outcome = check("tick=10 ms");
    assert_eq!(outcome.status, 2);
    assert!(outcome.err.contains("--set: `tick`"), "{}", outcome.err);
    let document: Result<Value, _> = serde_json::from_str(&outcome.out);
    assert!(document.is_ok(), "{}", outcome.out);
    // In this program, `tick` is the parameter of the scene.
    let (status, _, err) = posts("check", &["--set", "tick=3"]);
    assert_eq!(status, 2);
    assert!(err.contains("`tick` is a time"), "{err}");
}

#[test]
fn the_unit_decides_between_meanings_of_a_short_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "new.sa");
    let tank = fs::read_to_string("examples/microns.sa").unwrap();
    fs::write(&file, tank).unwrap();
    let outcome = stochc_with("check", &[&file, "--set", "agitation=310 K"]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
}

#[test]
fn the_patterns_of_the_examples_build_their_shapes() {
    let outcome = stochc_with(
        "check --deny warnings --allow-import examples/lib",
        &["tests/fixtures/parts.sa"],
    );
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    assert_eq!(outcome.out.matches("proved: builds").count(), 2);
}
