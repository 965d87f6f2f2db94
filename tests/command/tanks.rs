//! Tests the physical experiments. Each runs for a few seconds.
use crate::stochc::{path, stochc_with};

const EXAMPLES: [&str; 5] = [
    "experiment_1",
    "experiment_2",
    "experiment_3",
    "microns",
    "suction_growth",
];

#[test]
fn every_physical_example_runs_in_both_models() {
    for example in EXAMPLES {
        for model in ["rigid", "rapier"] {
            let file = format!("examples/{example}.sa");
            let arguments = [&*file, "--model", model, "--max-ticks", "150"];
            let outcome = stochc_with("simulate --runs 2 --quiet", &arguments);
            // Few programs complete within this time, but none may fail.
            assert!(
                [0, 3].contains(&outcome.status),
                "{example}: {}",
                outcome.err
            );
            assert_eq!(outcome.err, "", "{example}");
            assert!(
                !outcome.out.contains("Failed"),
                "{example}, {model}: {}",
                outcome.out
            );
        }
    }
}

#[test]
fn aggregates_do_not_depend_on_threads() {
    let run = |threads| {
        let arguments = ["--threads", threads, "--json"];
        let outcome = stochc_with(
            "simulate examples/experiment_2.sa --runs 3 --quiet --max-ticks 1500",
            &arguments,
        );
        outcome.out
    };
    let out = run("1");
    assert_eq!(out, run("3"));
    assert!(out.contains("completed"), "{out}");
}

#[test]
fn a_tank_is_recorded_and_shown_with_its_enclosure() {
    let folder = tempfile::tempdir().unwrap();
    let (out, page) = (path(folder.path(), "runs"), path(folder.path(), "run.html"));
    let arguments = ["--out", &out, "--record", "0"];
    let outcome = stochc_with(
        "simulate examples/experiment_1.sa --runs 1 --quiet --max-ticks 40",
        &arguments,
    );
    assert_eq!(outcome.err, "");
    let outcome = stochc_with("replay --run 0", &[&out, "--out", &page]);
    assert_eq!((outcome.status, &*outcome.err), (0, ""));
    let written = std::fs::read_to_string(page).unwrap();
    // The radius of 33 cm is 3.3 block lengths. The lift is the height of the sphere's centre above
    // a plate of 3 x 3.
    assert!(written.contains(r#""radius":3.3"#), "no radius");
    let lift = (3.3f64 * 3.3 - 4.5).sqrt();
    assert!(
        written.contains(&format!(r#""lift":{:.6}"#, lift)[..13]),
        "no lift"
    );
}

/// Checks that rising blocks build below a plate on the roof. They float away from a plate on the
/// floor.
#[test]
fn rising_blocks_gather_at_a_plate_on_the_roof() {
    let folder = tempfile::tempdir().unwrap();
    let file = path(folder.path(), "tank.sa");
    let outcome = |mount: &str| {
        let text = format!(
            "scene tank {{
                tick 20 ms
                block cube {{ side 10 cm  mass 0.95 kg  faces 2 }}
                free 60 uniform
                enclosure cylinder {{ radius 60 cm  height 150 cm  wall 200 N/m }}
                mount {mount}
                gravity 9.81 m/s^2
                fluid {{ density 1000 kg/m^3 }}
                agitation turbulence {{ speed 30 cm/s  length 20 cm }}
                contact {{ restitution 0.2  friction 0.3 }}
                bond attract {{ pull 2 N within 10 cm  anchor centres 1 mm tilt 26 deg }}
            }}
            assembly bracket in tank {{
                seed plate 3 x 3 {{ M at (1, 1) }}
                phase grow {{ M.up ->> T[1..2]  T[2].east -> A }}
            }}"
        );
        std::fs::write(&file, text).unwrap();
        stochc_with("simulate --runs 1 --quiet --max-ticks 3000", &[&file])
    };
    let (roof, floor) = (outcome("roof"), outcome("floor"));
    assert_eq!(
        (roof.status, floor.status),
        (0, 3),
        "{}{}",
        roof.err,
        floor.err
    );
}
