//! Tests names, scenes and files of the programs that `stochc plan` writes.
use std::fs;

use crate::plan::wrong;
use crate::stochc::{path, stochc_with};

const PLAN: &str = "plan --quiet --tries 1";

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
    let said = stochc_with(PLAN, &[&shape, "--scene", &format!("{lab}:tank")]);
    assert_eq!(said.status, 0, "{}", said.err);
    for part in ["scene tank from basin", "scene basin from", "in tank {"] {
        assert!(said.out.contains(part), "{part}: {}", said.out);
    }
    let refused = |scene: &str, part: &str| {
        let (status, told) = wrong(PLAN, &[&shape, "--scene", scene]);
        assert_eq!((status, told.contains(part)), (2, true), "{told}");
    };
    refused(&format!("{lab}:none"), "it declares `tank`, `basin`");
    refused(&lab, "does not have exactly one scene");
    refused(&path(folder.path(), "none.sa"), "none.sa");
    let one = file("one.sa", "scene only from hemisphere { free 30 uniform }\n");
    let said = stochc_with(PLAN, &[&shape, "--scene", &one, "--free", "60"]);
    assert!(
        said.out.contains("scene only_60 from only"),
        "{}{}",
        said.out,
        said.err
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
    let said = stochc_with(PLAN, &[&file]);
    assert!(said.out.contains("in lab {"), "{}", said.out);
    assert!(
        said.err.contains("planned in `lab`, the only scene of"),
        "{}",
        said.err
    );
    fs::write(&file, format!("{one}scene other from lab {{ }}\n")).unwrap();
    let said = stochc_with(PLAN, &[&file]);
    assert!(!said.out.contains("in lab {"), "{}", said.out);
    let told = "planned in `hemisphere`; ";
    assert!(said.err.contains(told), "{}", said.err);
    assert!(
        said.err
            .contains("declares `lab`, `other`: choose one with `--scene`"),
        "{}",
        said.err
    );
}

#[test]
fn an_assembly_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "two.txt");
    fs::write(&file, "##\n").unwrap();
    let said = stochc_with(PLAN, &[&file, "--name", "pair"]);
    assert!(said.out.contains("assembly pair {"), "{}", said.out);
    for (name, part) in [
        ("two", "the name of the shape"),
        ("up", "is not a name"),
        ("2x", "is not a name"),
        ("a b", "is not a name"),
        ("", "is not a name"),
    ] {
        let (status, told) = wrong(PLAN, &[&file, "--name", name]);
        assert_eq!((status, told.contains(part)), (2, true), "{name}: {told}");
    }
}

#[test]
fn output_is_replaced_if_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "two.txt");
    fs::write(&file, "##\n").unwrap();
    let out = path(folder.path(), "out.sa");
    assert_eq!(stochc_with(PLAN, &[&file, "--out", &out]).status, 0);
    assert_eq!(stochc_with(PLAN, &[&file, "--out", &out]).status, 2);
    let again = ["--out", &out, "--force", "--name", "again"];
    let said = stochc_with(PLAN, &[&[file.as_str()], &again[..]].concat());
    assert_eq!(said.status, 0, "{}", said.err);
    assert!(fs::read_to_string(&out).unwrap().contains("assembly again"));
    let mine = path(folder.path(), "mine.sa");
    fs::write(&mine, "let mine = 1\n").unwrap();
    let (status, told) = wrong(PLAN, &[&file, "--out", &mine, "--force"]);
    assert_eq!(
        (status, told.contains("was not written by stochc")),
        (2, true),
        "{told}"
    );
    // The output must not replace the target.
    let (status, told) = wrong(PLAN, &[&out, "--out", &out, "--force"]);
    assert_eq!(
        (status, told.contains("is the target: write")),
        (2, true),
        "{told}"
    );
    assert!(fs::read_to_string(&out).unwrap().contains("assembly again"));
    assert_eq!(stochc_with(PLAN, &[&file, "--force"]).status, 2);
}

#[test]
fn what_scaffolds_gain_is_reported() {
    let explained = |more: &[&str]| {
        let shape = "lab/planner/shapes/line.txt";
        let said = stochc_with("plan --quiet --explain", &[&[shape], more].concat());
        let line = said
            .err
            .lines()
            .find(|line| line.starts_with("scaffolds: "));
        line.map(str::to_owned).unwrap_or(said.err)
    };
    let told = explained(&["--tries", "1"]);
    assert!(told.contains("not tried, the plate has no room"), "{told}");
    let told = explained(&["--tries", "1", "--plate", "4 x 4"]);
    assert!(
        told.contains("not tried, the search makes too few tries"),
        "{told}"
    );
    let told = explained(&["--tries", "200", "--plate", "4 x 4"]);
    assert!(told.contains("a gain of "), "{told}");
}
