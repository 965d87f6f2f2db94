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

/// Plans a shape in a planar world, where the seed is among the cells. Programs cannot be completed
/// there.
#[test]
fn shapes_are_planned_in_planar_worlds() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "table.sa");
    let table = fs::read_to_string("examples/lab/air_table.sa").unwrap();
    let (scene, _) = table.split_once("/// A T").unwrap();
    let shape = "shape tee { layer 1 {\n# # #\n. # .\n. . .\n} }";
    let text = |phase: &str| {
        format!(
            "{scene}{shape}
            assembly build in air_table {{
                seed plate 3 x 3 {{ M at (1, 0) }}
                phase grow {{ {phase} }}
            }}"
        )
    };
    fs::write(&file, text("M.north -> A")).unwrap();
    let out = path(folder.path(), "planned.sa");
    let outcome = stochc_with(PLAN, &[&file, "--out", &out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let program = fs::read_to_string(&out).unwrap();
    assert!(program.contains("P[1, 0].north ->"), "{program}");
    let checked = stochc_with("check --deny warnings", &[&out]);
    assert_eq!(checked.status, 0, "{}", checked.err);
    let run = "simulate --model shuffle --runs 20 --quiet";
    let outcome = stochc_with(run, &[&out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let drawing = path(folder.path(), "pair.txt");
    fs::write(&drawing, "##\n").unwrap();
    let scene = format!("{file}:air_table");
    let (status, message) = wrong(PLAN, &[&drawing, "--scene", &scene]);
    let help = "or name their positions (`--plate`)";
    assert_eq!((status, message.contains(help)), (1, true), "{message}");
    let plate = ["--plate", "3 x 3 at (2, 0)"];
    let outcome = stochc_with(
        PLAN,
        &[&[&*drawing, "--scene", &scene], &plate[..]].concat(),
    );
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    // The seed holds both blocks in the plane, but none of them in space.
    for option in ["--drop-loose", "--supports"] {
        let arguments = [&[&*drawing, "--scene", &scene, option], &plate[..]].concat();
        let with_option = stochc_with(PLAN, &arguments);
        assert_eq!((with_option.status, &with_option.out), (0, &outcome.out));
    }
    fs::write(&file, text("yields tee")).unwrap();
    let (status, message) = wrong(PLAN, &[&file, "--complete"]);
    let expected = "in a planar world, only whole shapes can be planned";
    assert_eq!((status, message.contains(expected)), (1, true), "{message}");
}
