//! Tests names, scenes and files of the programs that `stochc plan` writes.
use std::fs;

use crate::plan::wrong;
use crate::stochc::{path, stochc_with};

const PLAN: &str = "plan --tries 1";

#[test]
fn a_scene_may_come_from_another_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        fs::write(folder.path().join(name), text).unwrap();
        path(folder.path(), name)
    };
    let shape = file("shape.txt", "##\n");
    let lab = file(
        "lab.sa",
        "scene tank from basin { free 80 uniform }\nscene basin from hemisphere { tick 10ms }\n",
    );
    let outcome = stochc_with(PLAN, &[&shape, "--scene", &format!("{lab}:tank")]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    for part in ["scene tank from basin", "scene basin from", "in tank {"] {
        assert!(outcome.out.contains(part), "{part}: {}", outcome.out);
    }
    let refused = |scene: &str, part: &str| {
        let (status, message) = wrong(PLAN, &[&shape, "--scene", scene]);
        assert_eq!((status, message.contains(part)), (2, true), "{message}");
    };
    refused(&format!("{lab}:none"), "it declares `tank`, `basin`");
    refused(&lab, "does not have exactly one scene");
    refused(&path(folder.path(), "none.sa"), "none.sa");
    let one = file("one.sa", "scene only from hemisphere { free 30 uniform }\n");
    let outcome = stochc_with(PLAN, &[&shape, "--scene", &one, "--free", "60"]);
    assert!(
        outcome.out.contains("scene only_60 from only"),
        "{}{}",
        outcome.out,
        outcome.err
    );
}

/// Checks that the only scene of a file is used. If there are several, none is used, and the
/// command reports this.
#[test]
fn the_scene_that_is_used_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "lab.sa");
    let one = "shape s { layer 1 { # } }\nscene lab from hemisphere { free 80 uniform }\n";
    fs::write(&file, one).unwrap();
    let outcome = stochc_with(PLAN, &[&file]);
    assert!(outcome.out.contains("in lab {"), "{}", outcome.out);
    assert!(
        outcome.err.contains("planned in `lab`, the only scene of"),
        "{}",
        outcome.err
    );
    fs::write(&file, format!("{one}scene other from lab {{ }}\n")).unwrap();
    let outcome = stochc_with(PLAN, &[&file]);
    assert!(!outcome.out.contains("in lab {"), "{}", outcome.out);
    let expected = "planned in `hemisphere`; ";
    assert!(outcome.err.contains(expected), "{}", outcome.err);
    assert!(
        outcome
            .err
            .contains("declares `lab`, `other`: choose one with `--scene`"),
        "{}",
        outcome.err
    );
}

#[test]
fn an_assembly_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "two.txt");
    fs::write(&file, "##\n").unwrap();
    let outcome = stochc_with(PLAN, &[&file, "--name", "pair"]);
    assert!(outcome.out.contains("assembly pair {"), "{}", outcome.out);
    for (name, part) in [
        ("two", "the name of the shape"),
        ("up", "is not a name"),
        ("2x", "is not a name"),
        ("a b", "is not a name"),
        ("", "is not a name"),
    ] {
        let (status, message) = wrong(PLAN, &[&file, "--name", name]);
        assert_eq!(
            (status, message.contains(part)),
            (2, true),
            "{name}: {message}"
        );
    }
}

#[test]
fn output_is_replaced_on_request() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "two.txt");
    fs::write(&file, "##\n").unwrap();
    let out = path(folder.path(), "out.sa");
    assert_eq!(stochc_with(PLAN, &[&file, "--out", &out]).status, 0);
    assert_eq!(stochc_with(PLAN, &[&file, "--out", &out]).status, 2);
    let again = ["--out", &out, "--force", "--name", "again"];
    let outcome = stochc_with(PLAN, &[&[file.as_str()], &again[..]].concat());
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(fs::read_to_string(&out).unwrap().contains("assembly again"));
    let mine = path(folder.path(), "mine.sa");
    fs::write(&mine, "let mine = 1\n").unwrap();
    let (status, message) = wrong(PLAN, &[&file, "--out", &mine, "--force"]);
    assert_eq!(
        (status, message.contains("was not written by stochc")),
        (2, true),
        "{message}"
    );
    // The output must not replace the target.
    let (status, message) = wrong(PLAN, &[&out, "--out", &out, "--force"]);
    assert_eq!(
        (status, message.contains("is the target: write")),
        (2, true),
        "{message}"
    );
    assert!(fs::read_to_string(&out).unwrap().contains("assembly again"));
    assert_eq!(stochc_with(PLAN, &[&file, "--force"]).status, 2);
}

#[test]
fn the_gain_of_scaffolds_is_reported() {
    let explained = |more: &[&str]| {
        let shape = "lab/planner/shapes/line.txt";
        let outcome = stochc_with("plan --quiet --explain", &[&[shape], more].concat());
        let line = outcome
            .err
            .lines()
            .find(|line| line.starts_with("scaffolds: "));
        line.map(str::to_owned).unwrap_or(outcome.err)
    };
    let explanation = explained(&["--tries", "1"]);
    assert!(
        explanation.contains("not tried, the plate has no room"),
        "{explanation}"
    );
    let explanation = explained(&["--tries", "1", "--plate", "4 x 4"]);
    assert!(
        explanation.contains("not tried, the search makes too few tries"),
        "{explanation}"
    );
    let explanation = explained(&["--tries", "200", "--plate", "4 x 4"]);
    assert!(explanation.contains("a gain of "), "{explanation}");
}
