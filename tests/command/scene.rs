//! Tests the listing of `--physics`, and warnings about scenes.
use std::ops::ControlFlow;

use serde_json::Value;
use stochc::ir::table::PhaseId;
use stochc::runtime::observe::{ObservedEvent, Observer};
use stochc::runtime::world::SpatialWorld;
use stochc::runtime::{Model, Settings, observe};

use crate::stochc::{path, stochc, stochc_with};

#[test]
fn the_default_scene_is_listed_with_what_it_leaves_unresolved() {
    let outcome = stochc("check --physics tests/fixtures/tower.sa");
    assert_eq!(
        (outcome.status, outcome.err.as_str()),
        (0, ""),
        "warnings of a scene are no findings"
    );
    insta::assert_snapshot!(outcome.out);
}

#[test]
fn a_scene_of_the_program_is_listed() {
    let outcome = stochc("check --physics tests/fixtures/soft.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    insta::assert_snapshot!(outcome.out);
}

#[test]
fn scenes_are_part_of_the_json_document() {
    let outcome =
        stochc("check --physics --json tests/fixtures/careless.sa tests/fixtures/soft.sa");
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    let document = outcome.json();
    assert_eq!(document["diagnostics"][0]["code"], "unused-seed");
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
        (&64.0.into(), &false.into(), &3.into())
    );
    assert_eq!(hemisphere["warnings"].as_array().unwrap().len(), 0);
    let steps = serde_json::json!({ "taken": "2/8", "needed": 3, "resolved": true });
    assert_eq!(hemisphere["steps"], steps);
    assert_eq!(hemisphere["speed"]["from"], "collisions");
    let outcome = stochc("check --json tests/fixtures/careless.sa").json();
    assert_eq!(outcome["diagnostics"], document["diagnostics"]);
    assert!(outcome.get("scenes").is_none(), "{outcome:#}");
}

#[test]
fn a_scene_is_listed_once_also_for_a_wrong_program() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "several.sa");
    let assembly = |name: &str, scene: &str| {
        format!(
            "assembly {name} {scene} {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> A }} }}\n"
        )
    };
    let text = [
        "scene calm from hemisphere { agitation kicks { speed 0 .. 5 mm/s }\n drag { rate 5 Hz }\n \
         bond attract { pull 1 N within 20 cm  anchor gap 1 cm } }\n"
            .to_owned(),
        assembly("a", ""),
        assembly("b", "in calm"),
        assembly("c", "in hemisphere"),
    ];
    std::fs::write(&file, text.concat()).unwrap();
    let outcome = stochc_with("check --physics", &[&file]);
    assert_eq!((outcome.status, outcome.err.as_str()), (0, ""));
    let heads: Vec<_> = (outcome.out.lines())
        .filter_map(|line| line.strip_prefix(&file)?.strip_prefix(": scene "))
        .collect();
    assert_eq!(heads, ["hemisphere, of a, c", "calm, of b"]);
    let (_, calm) = outcome.out.split_once("scene calm").unwrap();
    assert!(
        calm.ends_with(
            "\n\n  The time step is small enough (2 substeps per tick, 8 near open faces).\n  \
             One substep per tick would be enough.\n"
        ),
        "{calm}"
    );

    // An error outside of the scene is reported in addition to its physics.
    let outcome = stochc("check --physics tests/fixtures/wrong.sa");
    assert_eq!(outcome.status, 1);
    assert!(
        outcome
            .out
            .starts_with("tests/fixtures/wrong.sa: scene hemisphere")
    );
    assert!(outcome.err.contains("error["), "{}", outcome.err);
    // With `--format short`, standard output has only diagnostics.
    let outcome = stochc("check --physics --format short tests/fixtures/tower.sa");
    assert_eq!((outcome.status, outcome.out.as_str()), (0, ""));
    assert!(outcome.err.contains("scene hemisphere, of tower"));
}

/// Checks that `simulate` warns about a long time step, and that a sweep checks each point only
/// once.
#[test]
fn an_unresolved_scene_is_reported_by_simulate() {
    let line = "simulate --runs 1 --max-ticks 1 tests/fixtures/dense.sa --substeps";
    let errors_with = |steps: &str| stochc_with(line, &[steps]).err;
    assert!(!errors_with("4").contains("warning"));
    let one = errors_with("1");
    let title = "warning[coarse-step]: in scene `dense`, blocks overlap deeply";
    assert_eq!(one.matches(title).count(), 1, "{one}");
    // The warning can be denied like any other.
    let denied = stochc_with(line, &["1", "--deny", "warnings"]);
    assert_eq!(denied.status, 1, "{}", denied.err);
    for text in [
        "v τ / a is ",
        "F τ² / (m d) is 6, more than 1 with 1 substep per tick: a pulled",
        "run with `--substeps 3`, or shorten the `tick`",
    ] {
        assert!(denied.err.contains(text), "{}", denied.err);
    }
    let allowed = stochc_with(line, &["1", "--allow", "coarse-step"]);
    assert_eq!(allowed.status, 3);
    assert!(!allowed.err.contains("coarse-step"), "{}", allowed.err);
    // A sweep has many scenes. It prints only one warning in addition to the warning about the
    // source.
    let line = line.replace("simulate", "sweep");
    let swept = stochc_with(&line, &["1", "--vary", "free=5..9/3"]).err;
    assert_eq!(swept.matches("F τ² / (m d) is 6").count(), 1, "{swept}");
    assert!(
        swept.contains("dense [free=5] and 2 other programs: "),
        "{swept}"
    );
    // A model without physics has no time step.
    let line = "simulate --quiet --runs 1 --model shuffle tests/fixtures/dense.sa";
    assert_eq!(stochc(line).err, "");
}

/// Checks that drag counts: the steps of `microns.sa` suffice for the motion of its blocks.
#[test]
fn a_scene_dominated_by_drag_is_resolved() {
    let outcome = stochc("check --physics --json examples/microns.sa").json();
    let scene = &outcome["scenes"][0];
    assert_eq!(scene["warnings"], serde_json::json!([]));
    let groups = scene["groups"].as_array().unwrap();
    let pull = groups
        .iter()
        .find(|it| it["symbol"] == "φ F τ² / (m d)")
        .unwrap();
    assert_eq!(pull["substeps"], 1);
    // The times are the same for these numbers of steps.
    for steps in [1, 4, 16] {
        let line = format!(
            "simulate --substeps {steps} --quiet --runs 1 --max-ticks 1 examples/microns.sa"
        );
        assert_eq!(stochc(&line).err, "");
    }
}

/// Checks a scene whose blocks are 1.8 % heavier than the stirred fluid, so that they lie on the
/// floor.
#[test]
fn warns_of_sinking_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "tank.sa");
    let text = "scene tank from suction_tank { block cube { side 10cm  mass 1018g  faces 5 }\n fluid \
                { density 1 g/cm^3  viscosity 1 mPa s } }\nassembly a in tank { seed plate 1 x 1 { M at (0, 0) } \
                phase p { M.up -> A.up -> B } }\n";
    std::fs::write(&file, text).unwrap();
    let outcome = stochc_with("check --physics", &[&file]);
    assert!(
        outcome.out.contains("warning[buoyant-blocks]"),
        "{}",
        outcome.out
    );
    assert!(
        outcome.out.contains("fluid { density 1000 kg/m^3"),
        "{}",
        outcome.out
    );
    let outcome = stochc_with("simulate --runs 1 --max-ticks 1", &[&file]);
    assert_eq!(
        outcome.err.matches("most blocks lie on the floor").count(),
        1,
        "{}",
        outcome.err
    );
    assert!(
        outcome
            .err
            .contains("layer 2 has 1.5 % of their mean density, less than 10 %"),
        "{}",
        outcome.err
    );
    // A structure along the floor can still be built.
    std::fs::write(&file, text.replace("A.up -> B", "A")).unwrap();
    let outcome = stochc_with("simulate --runs 1 --max-ticks 1", &[&file]);
    assert!(!outcome.err.contains("warning"), "{}", outcome.err);
}

/// Dimensionless numbers and their limits fit into 80 columns.
#[test]
fn tables_of_physics_fit_the_terminal() {
    for file in [
        "line",
        "microns",
        "experiment_1",
        "experiment_2",
        "suction_growth",
        "lab/bowl",
    ] {
        let outcome = stochc(&format!("check --physics examples/{file}.sa")).out;
        let tables = outcome.split("dimensionless numbers").skip(1);
        for line in
            tables.flat_map(|table| table.lines().take_while(|it| !it.contains(".sa: scene ")))
        {
            assert!(line.chars().count() <= 80, "{file}: {line}");
        }
    }
}

/// Returns a scene without agitation. Its blocks float, or sink without a floor.
fn tank(wall: &str, density: &str, contact: &str) -> String {
    format!(
        "scene tank {{ tick 5 ms\n block cube {{ side 20 cm  mass 1 kg  faces 1 }}\n free 1 uniform\n \
         enclosure hemisphere {{ radius 2 m  wall {wall} }}\n gravity 9.81 m/s^2\n \
         fluid {{ density {density}  viscosity 20 Pa s }}\n {contact}\n \
         bond attract {{ pull 0.1 N within 20 cm  anchor centres 1 mm tilt 26 deg }} }}\n\
         assembly a in tank {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> A }} }}\n"
    )
}

/// Checks walls that hold floating or sinking blocks. The net force on a block is (8 kg - 1 kg) g,
/// or -0.2 g times 1 kg. A wall balances it with its stiffness times 20 cm.
#[test]
fn warns_of_walls_too_soft_for_buoyant_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "tank.sa");
    let contact = "contact { stiffness 250 N/m  damping 6 N s/m  friction 1 }";
    for (wall, density, contact, depth, remedy) in [
        ("25 N/m", "1000 kg/m^3", contact, 13.734, "a stiffer `wall`"),
        ("25 N/m", "1000 kg/m^3", "", 13.734, "a stiffer `wall`"),
        ("1 kN/m", "1000 kg/m^3", contact, 0.34335, ""),
        ("3 N/m", "100 kg/m^3", "", 3.27, "there is no floor"),
        ("3 N/m", "100 kg/m^3", contact, f64::NAN, ""),
    ] {
        std::fs::write(&file, tank(wall, density, contact)).unwrap();
        let outcome = stochc_with("check --physics --json", &[&file]);
        assert_eq!(outcome.status, 0, "{}", outcome.err);
        let scene = &outcome.json()["scenes"][0];
        let groups = scene["groups"].as_array().unwrap();
        let group = groups.iter().find(|it| it["symbol"] == "F / (k a), wall");
        if depth.is_nan() {
            assert_eq!(group, None)
        } else {
            let value = group.unwrap()["value"].as_f64().unwrap();
            assert!((value / depth - 1.0).abs() < 1e-9, "{value}");
        }
        let warnings = scene["warnings"].to_string();
        let is_reported = |text: &str| text.contains("soft-contact");
        assert_eq!(is_reported(&warnings), !remedy.is_empty(), "{warnings}");
        assert!(warnings.contains(remedy), "{warnings}");
        let run = stochc_with("simulate --runs 1 --max-ticks 1", &[&file]);
        assert_eq!(is_reported(&run.err), !remedy.is_empty(), "{}", run.err);
    }
}

/// Observer of the height of the last free block.
#[derive(Default)]
struct Last(Vec<f64>);

impl Observer for Last {
    fn look(&mut self, arena: &impl SpatialWorld, _: &[ObservedEvent]) {
        self.0 = arena.state(0).position.iter().copied().collect();
    }
}

/// Checks the position of a block at rest against its closed form.
#[test]
fn the_reported_depth_in_the_wall_is_right() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "tank.sa");
    for (wall, density, depth) in [
        ("25 N/m", "1000 kg/m^3", 13.734),
        ("3 N/m", "100 kg/m^3", 3.27),
    ] {
        std::fs::write(&file, tank(wall, density, "")).unwrap();
        let program = stochc::check(&file).programs.remove(0);
        let (tables, scene) = (program.tables.unwrap(), program.scene.unwrap());
        let mut settings = Settings::new(Model::Rigid, 1);
        settings.max_ticks = Some(200_000);
        let mut watch = |_: u64, _: PhaseId| ControlFlow::Continue(());
        let mut last = Last::default();
        observe(&tables, &scene, &settings, 5, 0, &mut watch, &mut last).unwrap();
        let distance = last.0.iter().map(|x| x * x).sum::<f64>().sqrt();
        // The radius of the enclosure is 10 block lengths.
        assert!(
            (distance - 10.0 - depth).abs() < 1e-3,
            "{distance} and {depth}"
        );
    }
}

/// Checks a compiled file with a scene without motion. It has no source, but the warning can be
/// denied.
#[test]
fn a_scene_without_motion_can_be_denied() {
    let folder = tempfile::tempdir().unwrap();
    let [text, compiled] = ["a.sa", "a.json"].map(|name| path(folder.path(), name));
    let program = "scene still from hemisphere { agitation kicks { speed 0 .. 0 m/s } }\n\
        assembly a in still { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }\n";
    std::fs::write(&text, program).unwrap();
    let found = stochc_with("check --json", &[&text]);
    assert_eq!(
        (found.status, &found.json()["diagnostics"][0]["code"]),
        (0, &"no-agitation".into())
    );
    let made = stochc_with("compile --emit executable --out", &[&compiled, &text]);
    assert_eq!(made.status, 0, "{}", made.err);
    for file in [&text, &compiled] {
        let run = |level: &str| {
            let line = format!("simulate --runs 1 --max-ticks 1 {level} no-agitation");
            stochc_with(&line, &[file])
        };
        let [warned, denied, allowed] = ["--warn", "--deny", "--allow"].map(run);
        let reported =
            [&warned, &denied, &allowed].map(|outcome| outcome.err.contains("no-agitation"));
        assert_eq!(reported, [true, true, false], "{}", warned.err);
        assert_eq!([warned.status, denied.status, allowed.status], [3, 1, 3]);
    }
}

/// Checks a sweep that removes the agitation. It causes a warning, also with `--quiet`.
#[test]
fn warnings_of_the_points_of_a_sweep_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "a.sa");
    let program = "scene still from hemisphere { agitation kicks { speed 0 .. 1 m/s } }\n\
        assembly a in still { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }\n";
    std::fs::write(&file, program).unwrap();
    for quiet in ["", "--quiet"] {
        let line = format!("sweep {quiet} --runs 1 --max-ticks 1 --vary agitation.speed=0");
        let outcome = stochc_with(&line, &[&file]);
        assert!(outcome.err.contains("no-agitation"), "{}", outcome.err);
    }
}

/// Checks that a listing states whether the time step is small enough, and marks values beyond
/// their limit.
#[test]
fn rows_outside_of_their_limit_are_marked() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "a.sa");
    let program = "scene slow from hemisphere { drag { rate 650 Hz } }\n\
        assembly a in slow { seed plate 1 x 1 { M at (0, 0) } phase p { M.up -> A } }\n";
    std::fs::write(&file, program).unwrap();
    let outcome = stochc_with("check --physics", &[&file]);
    let marked: Vec<&str> = outcome
        .out
        .lines()
        .filter(|line| line.ends_with("exceeded"))
        .collect();
    assert_eq!(marked.len(), 1, "{}", outcome.out);
    assert!(marked[0].trim_start().starts_with("γ τ"), "{}", outcome.out);
    assert!(
        outcome
            .out
            .contains("The time step is too long (2 substeps per tick, 8 near open faces)."),
        "{}",
        outcome.out
    );
    assert!(
        outcome
            .out
            .contains("displacements are 100 times too small"),
        "{}",
        outcome.out
    );
    let json = stochc_with("check --physics --json", &[&file]).json();
    let groups = json["scenes"][0]["groups"].as_array().unwrap();
    let exceeded = groups.iter().filter(|it| it["exceeded"] == true);
    assert_eq!(exceeded.count(), 1);
    assert_eq!(json["scenes"][0]["steps"]["resolved"], false);
    assert_eq!(json["scenes"][0]["warnings"][0]["code"], "coarse-step");
}
