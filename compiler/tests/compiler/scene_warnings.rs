//! Warnings about scenes that cannot work.
use stochc_ir::scene::warnings::{SceneWarning, SceneWarningKind, Stepping, scene_warnings};
use stochc_ir::scene::{Agitation, Scene, Substeps};

use stochc_compiler::diagnostic::{Code, Diagnostic, Severity};
use stochc_compiler::scene::built_in;
use stochc_compiler::{Checked, Level, Limits, LintLevels, check_with};

fn checked(text: &str, levels: &LintLevels) -> Checked {
    let mut reader = |_: &str| Ok(text.as_bytes().to_vec());
    check_with("a.sa", &mut reader, Limits::default(), levels)
}

/// Returns the scene of the first assembly of a text.
fn scene(text: &str) -> Scene {
    let mut checked = checked(text, &LintLevels::default());
    checked
        .programs
        .remove(0)
        .scene
        .expect("the program is valid")
}

/// Returns a program with a scene, based on the default one with these clauses, and the body of its
/// assembly.
fn program(clauses: &str, body: &str) -> String {
    format!(
        "scene s from hemisphere {{ {clauses} }}
        assembly a in s {{ {body} seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up -> A }} }}"
    )
}

/// Returns the codes of the warnings.
fn codes(text: &str) -> Vec<Code> {
    let checked = checked(text, &LintLevels::default());
    checked.diagnostics.iter().map(|it| it.code).collect()
}

/// Returns a program with cubes of 1.5 cm and 3.4 g in a fluid. Its assembly has `layers` layers.
fn lab(density: &str, speed: &str, layers: u32) -> String {
    format!(
        "scene lab {{
            tick 20 ms  block cube {{ side 1.5 cm  mass 3.4 g  faces 5 }}  free 40 uniform
            enclosure hemisphere {{ radius 25 cm  wall 20 N/m }}
            gravity 9.81 m/s^2  fluid {{ density {density} }}
            agitation kicks {{ speed 0 .. {speed} }}
            contact {{ restitution 0.2  friction 0.3 }}
            bond attract {{ pull 2 mN within 1.5 cm  anchor centres 1 mm tilt 26 deg }}
        }}
        assembly a in lab {{ seed plate 1 x 1 {{ M at (0, 0) }} phase p {{ M.up ->> T[1..{layers}] }} }}"
    )
}

#[test]
fn warns_of_blocks_that_stay_away_from_the_structure() {
    let buoyant = [Code::BuoyantBlocks];
    for (text, expected) in [
        (lab("1.02 g/cm^3", "2 cm/s", 1), &buoyant[..]),
        (lab("1.0074 g/cm^3", "2 cm/s", 1), &[]),
        // The density at the structure matters, not the density at the settled blocks.
        (lab("1.02 g/cm^3", "2 cm/s", 16), &buoyant),
        (lab("0.99 g/cm^3", "2 cm/s", 16), &buoyant),
        // Blocks on the floor can reach the first layer.
        (lab("0.99 g/cm^3", "2 cm/s", 1), &[]),
        (lab("1.0075 g/cm^3", "30 cm/s", 16), &[]),
    ] {
        assert_eq!(codes(&text), expected, "{text}");
    }
}

#[test]
fn warns_of_scenes_without_motion() {
    let still = [Code::NoAgitation];
    for (clauses, expected) in [
        ("agitation kicks { speed 0 .. 0 m/s }", &still[..]),
        (
            "agitation kicks { speed 0 .. 0 m/s }  gravity 9.81 m/s^2",
            &still,
        ),
        ("agitation kicks { speed 0 .. 1 mm/s }", &[]),
        (
            "agitation kicks { speed 0 .. 0 m/s }  free 0 uniform",
            &[Code::TooFewBlocks],
        ),
    ] {
        assert_eq!(codes(&program(clauses, "")), expected, "{clauses}");
    }
    let mut still = built_in("hemisphere").expect("a built-in scene");
    still.agitation = None;
    let kinds = |scene: &Scene| -> Vec<SceneWarningKind> {
        let all = scene_warnings(scene, Stepping::DEFAULT, None);
        all.iter().map(|warning| warning.kind).collect()
    };
    assert_eq!(kinds(&still), [SceneWarningKind::NoAgitation]);
    // A pump draws blocks, and a flow carries them.
    for name in ["suction_tank", "magnet_tank"] {
        let mut scene = built_in(name).expect("a built-in scene");
        scene.agitation = None;
        assert!(
            !kinds(&scene).contains(&SceneWarningKind::NoAgitation),
            "{name}"
        );
    }
}

#[test]
fn warns_of_soft_contacts_and_walls() {
    let soft = [Code::SoftContact];
    for (clauses, expected) in [
        (
            "enclosure hemisphere { radius 5m  wall 0.05 N/m }",
            &soft[..],
        ),
        ("enclosure hemisphere { radius 5m  wall 100 N/m }", &[]),
        // m g / (k a) is 9.8 and 0.09.
        (
            "gravity 9.81 m/s^2  agitation kicks { speed 0 .. 4 m/s }
             contact { stiffness 5 N/m  damping 1 N s/m  friction 0.5 }",
            &soft,
        ),
        (
            "contact { stiffness 5 N/m  damping 1 N s/m  friction 0.5 }",
            &soft,
        ),
    ] {
        let found = codes(&program(clauses, ""));
        let found: Vec<Code> = found
            .into_iter()
            .filter(|it| *it == Code::SoftContact)
            .collect();
        assert_eq!(found, expected, "{clauses}");
    }
    // Eddies press blocks into the wall: at 0.1 m/s by inertia, at 1 m/s by drag.
    let mut tank = built_in("suction_tank").expect("a built-in scene");
    let symbols = |scene: &Scene| -> Vec<&'static str> {
        let all = scene_warnings(scene, Stepping::DEFAULT, None).into_iter();
        let soft = all.filter(|it| it.kind == SceneWarningKind::SoftContact);
        soft.map(|it| it.symbol).collect()
    };
    assert!(symbols(&tank).is_empty());
    let Some(Agitation::Turbulence(turbulence)) = &mut tank.agitation else {
        panic!("eddies stir it");
    };
    turbulence.strength = stochc_ir::scene::Strength::Speed(3.0);
    assert_eq!(symbols(&tank), ["F / (k a), wall", "v √(m/k) / a, wall"]);
}

#[test]
fn warns_of_fast_blocks_in_a_fluid_without_density() {
    let stokes = [Code::StokesDrag];
    let eddies = "agitation turbulence { speed 1 m/s  length 1 m }";
    for (clauses, expected) in [
        ("fluid { viscosity 1 mPa s }", &stokes[..]),
        ("fluid { viscosity 1 mPa s  density 125 kg/m^3 }", &[]),
        ("fluid { viscosity 20 Pa s }", &[]),
        ("drag { rate 0.01 Hz }", &[]),
        // Eddies carry blocks along.
        (&format!("fluid {{ viscosity 1 mPa s }}  {eddies}"), &[]),
    ] {
        let found = codes(&program(clauses, ""));
        let found: Vec<Code> = (found.into_iter())
            .filter(|it| *it == Code::StokesDrag)
            .collect();
        assert_eq!(found, expected, "{clauses}");
    }
    let reason = "allow stokes-drag \"the drag is calibrated\"";
    let allowed = codes(&program("fluid { viscosity 1 mPa s }", reason));
    assert!(!allowed.contains(&Code::StokesDrag) && !allowed.contains(&Code::UnusedAllow));
}

#[test]
fn the_reynolds_number_uses_the_expected_speed() {
    // m v / (a² η) is 10 at a = 20 cm and m = 1 kg.
    let with = |viscosity: f64| {
        let clauses = format!("fluid {{ viscosity {viscosity} mPa s }}");
        let scene = scene(&program(&clauses, ""));
        let numbers =
            stochc_ir::scene::dimensionless::dimensionless_numbers(&scene, Substeps::DEFAULT);
        let found = numbers.iter().find(|it| it.symbol == "m v / (a² η)");
        let speed = stochc_ir::scene::dimensionless::speed(&scene).rms.unwrap();
        (found.unwrap().value, speed / (0.04 * viscosity * 1e-3))
    };
    for viscosity in [1.0, 1e3, 1e5] {
        let (reported, exact) = with(viscosity);
        assert!((reported / exact - 1.0).abs() < 1e-9, "{reported} {exact}");
    }
}

#[test]
fn levels_apply_to_scene_warnings() {
    let text = program("agitation kicks { speed 0 .. 0 m/s }", "");
    let mut levels = LintLevels::default();
    levels.set(None, Level::Deny);
    let denied = checked(&text, &levels);
    let is_error = |it: &Diagnostic| it.severity == Severity::Error;
    assert!(denied.diagnostics.iter().all(is_error) && denied.has_errors());
    assert_eq!(denied.diagnostics[0].programs, [0]);
    let allowed = program(
        "agitation kicks { speed 0 .. 0 m/s }",
        "allow no-agitation \"nothing needs to move\"",
    );
    assert_eq!(codes(&allowed), []);
    // Runs without physics have no such warnings, and the `allow` does not count as unused.
    let without = LintLevels::default().for_runs(None);
    assert!(checked(&allowed, &without).diagnostics.is_empty());
    let spare = program("", "allow no-agitation \"it moves\"");
    assert_eq!(codes(&spare), [Code::UnusedAllow]);
}

#[test]
fn a_check_judges_the_steps_of_the_runs() {
    let text = program("tick 60 ms", "");
    let with = |steps: &str| {
        let stepping = Stepping {
            steps: steps.parse().expect("steps"),
            ..Stepping::DEFAULT
        };
        let checked = checked(&text, &LintLevels::default().for_runs(Some(stepping)));
        checked.diagnostics.len()
    };
    assert_eq!((with("1"), with("20/40")), (1, 0));
}

#[test]
fn warns_of_rotations_below_a_digit() {
    let mut scene = scene(include_str!("../../../examples/microns.sa"));
    let double = Stepping {
        smallest_turn: 0.0,
        ..Stepping::DEFAULT
    };
    let mut is_reported = |tick: f64, stepping: Stepping| {
        scene.tick = tick;
        let all = scene_warnings(&scene, stepping, None);
        all.iter().any(|warning| warning.symbol == "ω τ")
    };
    // In water a cube of 10 um turns by about 27 rad/s.
    assert!(!is_reported(1e-7, Stepping::DEFAULT));
    assert!(is_reported(1e-9, Stepping::DEFAULT));
    assert!(!is_reported(1e-9, double));
}

#[test]
fn the_advised_steps_resolve_every_limit() {
    let scene = scene(&program("tick 60 ms", ""));
    let with = |steps: Substeps| -> Vec<SceneWarning> {
        let stepping = Stepping {
            steps,
            ..Stepping::DEFAULT
        };
        scene_warnings(&scene, stepping, None)
    };
    for taken in ["2/8", "2/2", "1", "1/8"] {
        let taken: Substeps = taken.parse().expect("steps");
        let all = with(taken);
        assert!(!all.is_empty(), "{taken}");
        let advised = |warning: &SceneWarning| {
            let advice = warning.remedy.strip_prefix("run with `--substeps ");
            let (steps, _) = advice
                .and_then(|it| it.split_once('`'))
                .expect("there is advice");
            steps.to_owned()
        };
        let steps: Substeps = advised(&all[0]).parse().expect("they are allowed");
        assert!(
            all.iter().all(|it| advised(it) == steps.to_string()),
            "{all:?}"
        );
        assert!(steps.near >= taken.near && steps.away.is_some() == taken.away.is_some());
        assert_eq!(with(steps), []);
    }
}

/// The examples of these tanks capture in the first layer.
#[test]
fn built_in_tanks_have_no_warnings() {
    for name in ["hemisphere", "magnet_tank", "jet_tank", "suction_tank"] {
        let scene = built_in(name).expect("a built-in scene");
        assert_eq!(
            scene_warnings(&scene, Stepping::DEFAULT, Some(1..=1)),
            [],
            "{name}"
        );
    }
}
