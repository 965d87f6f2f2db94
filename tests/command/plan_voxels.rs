//! Tests `stochc plan` with voxel files (`.vox`) and text layers (`.txt`).
use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::plan::wrong;
use crate::stochc::{path, stochc_with};

/// Returns a MagicaVoxel file with these models and without a voxel scene.
pub fn vox(models: &[&[[u8; 4]]]) -> Vec<u8> {
    let chunk = |name: &[u8], content: &[u8], children: &[u8]| {
        let lengths = [content, children].map(|part| (part.len() as u32).to_le_bytes());
        [name, &lengths.concat(), content, children].concat()
    };
    let mut children = Vec::new();
    for voxels in models {
        let count = (voxels.len() as u32).to_le_bytes();
        let content = [&count[..], &voxels.concat()].concat();
        children.extend(chunk(b"SIZE", &[9, 0, 0, 0].repeat(3), &[]));
        children.extend(chunk(b"XYZI", &content, &[]));
    }
    let main = chunk(b"MAIN", &[], &children);
    [&b"VOX "[..], &150_u32.to_le_bytes(), &main].concat()
}

fn file(folder: &Path, name: &str, bytes: &[u8]) -> String {
    fs::write(folder.join(name), bytes).unwrap();
    path(folder, name)
}

fn planned(file: &str, more: &[&str]) -> Value {
    let line = "plan --quiet --tries 1 --json";
    stochc_with(line, &[&[file], more].concat()).json()
}

fn captures(document: &Value) -> usize {
    document["plan"]["captures"].as_array().unwrap().len()
}

#[test]
fn one_model_of_several_is_chosen() {
    let folder = tempfile::tempdir().unwrap();
    let two = vox(&[&[[0, 0, 0, 1], [1, 0, 0, 1]], &[[0; 4]], &[[0, 0, 0, 9]]]);
    let two = file(folder.path(), "two.vox", &two);
    let (status, message) = wrong("plan --quiet", &[&two]);
    assert_eq!(status, 2, "{message}");
    assert!(
        message.contains("2 models and no scene: 0 (2 voxels) and 2 (1 voxel)"),
        "{message}"
    );
    assert_eq!(captures(&planned(&two, &["--model", "0"])), 2);
    assert_eq!(captures(&planned(&two, &["--model", "2"])), 1);
    let (status, message) = wrong("plan --quiet --model 3", &[&two]);
    assert_eq!(
        (status, message.contains("no model 3")),
        (2, true),
        "{message}"
    );
    let (status, message) = wrong("plan --quiet --model 1", &[&two]);
    assert_eq!(
        (status, message.contains("no cells")),
        (1, true),
        "{message}"
    );
    let text = file(folder.path(), "one.txt", b"#\n");
    let (status, message) = wrong("plan --quiet --model 0", &[&text]);
    assert_eq!(
        (status, message.contains("`.vox` files")),
        (2, true),
        "{message}"
    );
}

#[test]
fn copies_are_built_and_hidden_models_are_reported() {
    let copies = planned("fuzz/corpus/voxels/instances.vox", &[]);
    assert_eq!(captures(&copies), 6);
    let (status, message) = wrong("plan", &["fuzz/corpus/voxels/hidden.vox"]);
    assert_eq!(status, 1, "{message}");
    assert!(message.contains("left out 2 hidden models of"), "{message}");
}

/// Checks a model with more cells than the default scene has blocks. The program then contains a
/// scene with enough blocks.
#[test]
fn a_large_model_gets_a_scene_with_enough_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let solid: Vec<[u8; 4]> = (0..301)
        .map(|i| [(i % 7) as u8, (i / 7 % 7) as u8, (i / 49) as u8, 1])
        .collect();
    let solid = file(folder.path(), "solid.vox", &vox(&[&solid]));
    let out = path(folder.path(), "solid.sa");
    let outcome = stochc_with("plan --tries 1", &[&solid, "--out", &out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    let note = "note: planned in `hemisphere_602`: `hemisphere` with 602 free blocks instead of 300 \
                and room for them at the same density, radius 6.307 m\n";
    assert!(outcome.err.contains(note), "{}", outcome.err);
    let written = fs::read_to_string(&out).unwrap();
    assert!(
        written.contains("scene hemisphere_602 from hemisphere {"),
        "{written}"
    );
    assert!(written.contains("free 602 uniform"), "{written}");
    assert!(written.contains("in hemisphere_602 {"), "{written}");
    assert_eq!(stochc_with("fmt --check", &[&out]).status, 0);
    let checked = stochc_with("check --deny warnings", &[&out]);
    assert_eq!(checked.status, 0, "{}", checked.err);
    // A scene that an option selects is not replaced.
    let (status, message) = wrong("plan --quiet --scene hemisphere", &[&solid]);
    assert_eq!(status, 1, "{message}");
    assert!(message.contains("(`--free`, `--scene`)"), "{message}");
    let document = planned(&solid, &["--scene", "hemisphere", "--free", "400"]);
    assert_eq!(document["scene"], "hemisphere_400");
}

/// Checks a tower of 40 cells, which does not fit into the default enclosure.
#[test]
fn a_high_model_gets_a_scene_with_enough_room() {
    let folder = tempfile::tempdir().unwrap();
    let tower = file(folder.path(), "tower.txt", "#\n\n".repeat(40).as_bytes());
    let out = path(folder.path(), "tower.sa");
    let outcome = stochc_with("plan --tries 1", &[&tower, "--out", &out]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(
        outcome.err.contains("at the same density"),
        "{}",
        outcome.err
    );
    assert_eq!(stochc_with("check", &[&out]).status, 0);
    // A few blocks in a large enclosure have a lower density.
    let outcome = stochc_with("plan --tries 1 --free 50", &[&tower]);
    assert_eq!(outcome.status, 0, "{}", outcome.err);
    assert!(outcome.err.contains("times its density"), "{}", outcome.err);
}

#[test]
fn loose_parts_are_all_reported_dropped_or_held() {
    let folder = tempfile::tempdir().unwrap();
    let (none, feet) = (".".repeat(31), "#".repeat(31));
    let corners = ".#.".repeat(10) + ".";
    let drawn = format!("{none}\n{feet}\n\n{corners}\n{none}\n");
    let drawn = file(folder.path(), "corners.txt", drawn.as_bytes());
    let outcome = stochc_with("plan --quiet --json", &[&drawn]);
    assert_eq!(outcome.status, 1, "{}", outcome.err);
    let document: Value = serde_json::from_str(&outcome.out).unwrap();
    let error = &document["error"];
    assert_eq!(error["kind"], "loose", "{error}");
    let parts = error["detail"].as_array().unwrap();
    assert_eq!(parts.len(), 10);
    assert!(
        parts
            .iter()
            .all(|part| part["bridge"].as_array().unwrap().len() == 1),
        "{error}"
    );
    assert!(
        outcome
            .err
            .contains("10 parts of the target, 10 cells in all"),
        "{}",
        outcome.err
    );
    assert_eq!(captures(&planned(&drawn, &["--drop-loose"])), 31);
    assert_eq!(captures(&planned(&drawn, &["--supports"])), 51);
    let outcome = stochc_with("plan --tries 1 --drop-loose", &[&drawn]);
    let note = "note: left out 10 loose parts with 10 cells\n";
    assert!(outcome.err.contains(note), "{}", outcome.err);
    assert!(outcome.out.contains("yields corners"), "{}", outcome.out);
}

/// Checks text layers whose lines end with a carriage return only, as on old systems.
#[test]
fn rows_may_end_with_carriage_returns() {
    let folder = tempfile::tempdir().unwrap();
    let drawn = file(folder.path(), "cr.txt", b"##\r##\r");
    let document = planned(&drawn, &[]);
    let captures = document["plan"]["captures"].as_array().unwrap();
    let is_north = |capture: &&Value| capture["cell"]["y"] == 1 || capture["cell"][1] == 1;
    assert_eq!(captures.len(), 4);
    assert_eq!(captures.iter().filter(is_north).count(), 2, "{document}");
}
