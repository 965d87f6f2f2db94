//! The physics that is in force.
use serde_json::Value;

use crate::stochc::{path, stochc, stochc_with};

#[test]
fn the_default_scene_is_listed_with_what_it_leaves_unresolved() {
    let said = stochc("check --scene tests/fixtures/tower.sa");
    assert_eq!(
        (said.status, said.err.as_str()),
        (0, ""),
        "warnings of a scene are no findings"
    );
    insta::assert_snapshot!(said.out);
}

#[test]
fn a_scene_of_the_program_is_listed() {
    let said = stochc("check --scene tests/fixtures/soft.sa");
    assert_eq!((said.status, said.err.as_str()), (0, ""));
    insta::assert_snapshot!(said.out);
}

#[test]
fn scenes_come_as_json_beside_the_findings() {
    let said =
        stochc("check --scene --format json tests/fixtures/careless.sa tests/fixtures/soft.sa");
    assert_eq!((said.status, said.err.as_str()), (0, ""));
    let document = said.json();
    assert_eq!(document["findings"][0]["code"], "unused-seed");
    let scenes = document["scenes"].as_array().unwrap();
    let names: Vec<_> = (scenes.iter())
        .map(|scene| (&scene["file"], &scene["scene"], &scene["assemblies"][0]))
        .map(|(file, scene, assembly)| [file, scene, assembly].map(|it| it.as_str().unwrap()))
        .collect();
    assert_eq!(
        names,
        [
            ["tests/fixtures/careless.sa", "hemisphere", "careless"],
            ["tests/fixtures/soft.sa", "soft", "soft"],
        ]
    );
    let find = |list: &Value, key: &str, name: &str| -> Value {
        let mut all = list.as_array().unwrap().iter();
        all.find(|it| it[key] == name).unwrap().clone()
    };
    let [hemisphere, soft] = [&scenes[0], &scenes[1]];
    let drag = find(&soft["terms"], "clause", "drag");
    assert_eq!(drag["text"], "drag { rate 0.5 s^-1 }");
    let rate = &drag["laws"][0]["values"][0];
    assert_eq!(
        (
            &rate["symbol"],
            &rate["unit"],
            rate["si"].as_f64(),
            rate["block"].as_f64()
        ),
        (&"γ".into(), &"1/s".into(), Some(0.5), Some(0.01))
    );
    assert_eq!(hemisphere["absent"][0]["clause"], "gravity");
    let pull = find(&hemisphere["groups"], "symbol", "F τ² / (m d)");
    assert_eq!(
        (&pull["most"], &pull["exceeded"], &pull["substeps"]),
        (&1.0.into(), &true.into(), &2.into())
    );
    assert_eq!(hemisphere["warnings"].as_array().unwrap().len(), 0);
    assert_eq!(hemisphere["speed"]["from"], "collisions");
    // Without the option the document is the findings alone.
    let said = stochc("check --format json tests/fixtures/careless.sa");
    assert_eq!(said.json(), document["findings"]);
}

#[test]
fn a_scene_is_listed_once_and_not_for_a_wrong_program() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "several.sa");
    let assembly = |name: &str, scene: &str| {
        format!(
            "assembly {name} {scene} {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> A }} }}\n"
        )
    };
    let text = [
        "scene calm from hemisphere { agitation kicks { speed 0 .. 5 mm/s }\n drag { rate 20 Hz }\n \
         bond attract { pull 1 N within 20 cm  anchor gap 1 cm } }\n"
            .to_owned(),
        assembly("a", ""),
        assembly("b", "in calm"),
        assembly("c", "in hemisphere"),
    ];
    std::fs::write(&file, text.concat()).unwrap();
    let said = stochc_with("check --scene", &[&file]);
    assert_eq!((said.status, said.err.as_str()), (0, ""));
    let heads: Vec<_> = (said.out.lines())
        .filter_map(|line| line.strip_prefix(&file)?.strip_prefix(": scene "))
        .collect();
    assert_eq!(heads, ["hemisphere, of a, c", "calm, of b"]);
    let (_, calm) = said.out.split_once("scene calm").unwrap();
    assert!(
        calm.ends_with("\n\n  One step a tick is short enough for all of these.\n"),
        "{calm}"
    );

    let said = stochc("check --scene tests/fixtures/wrong.sa");
    assert_eq!((said.status, said.out.as_str()), (1, ""));
    // Findings alone go to the standard output of a machine.
    let said = stochc("check --scene --format short tests/fixtures/tower.sa");
    assert_eq!((said.status, said.out.as_str()), (0, ""));
    assert!(said.err.contains("scene hemisphere, of tower"));
}
