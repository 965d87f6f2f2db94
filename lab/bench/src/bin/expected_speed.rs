//! Compares the speed that `stochc check --physics` expects with the measured speed of the blocks.
//!
//! Each row is the scene `hemisphere_2005` with one change. No face is magnetized. Speeds are in
//! block lengths per tick.
use stochc_compiler::scene::built_in;
use stochc_ir::scene::dimensionless::{BlockUnits, Gas, speed};
use stochc_ir::scene::{Agitation, Contact, ContactLaw, Drag, Scene};
use stochc_ir::table::Plate;
use stochc_runtime::world::rapier::RapierWorld;
use stochc_runtime::world::{SpatialWorld as _, World as _};
use stochc_runtime::{Model, Settings};

/// Number of ticks until blocks that start at rest have reached their speed.
const WARM_UP: usize = 3_000;
/// Number of observed ticks in each of [`RUNS`] runs.
const TICKS: usize = 3_000;
const RUNS: u64 = 4;
/// Distance from ground and shell beyond which a block collides only with blocks \[block lengths\].
const APART: f64 = 2.0;

fn main() {
    println!("                     rms speed           collisions a tick, away from the floor");
    println!("scene                expected  measured  expected  measured");
    for (name, scene, substeps) in scenes() {
        let units = BlockUnits::from_scene(&scene);
        let (Some(rms), Some(gas)) = (speed(&scene).rms, Gas::from_scene(&scene)) else {
            continue;
        };
        let (rms, seen) = (units.speed(rms), observe(&scene, substeps));
        println!(
            "{name:20} {rms:8.4}  {:8.4}  {:8.4}  {:8.4}",
            seen.rms,
            gas.meetings(rms),
            seen.meetings
        );
    }
}

fn scenes() -> Vec<(&'static str, Scene, u32)> {
    let scene = built_in("hemisphere_2005").expect("a built-in scene");
    let kicks = |scene: &Scene, factor: f64| {
        let mut scene = scene.clone();
        let Some(Agitation::Kicks { speed }) = &mut scene.agitation else {
            panic!("the scene is agitated");
        };
        speed.1 *= factor;
        scene
    };
    let contact = |restitution, friction| Scene {
        contact: Some(Contact {
            law: ContactLaw::Rigid { restitution },
            friction,
        }),
        ..scene.clone()
    };
    let drag = |rate| Scene {
        drag: Some(Drag { rate }),
        ..scene.clone()
    };
    let blocks = |count| {
        let mut scene = scene.clone();
        scene.free.count = count;
        scene
    };
    vec![
        ("hemisphere_2005", scene.clone(), 1),
        ("2 substeps", scene.clone(), 2),
        ("4 substeps", scene.clone(), 4),
        ("kicks x 1/4", kicks(&scene, 0.25), 1),
        ("kicks x 1/2", kicks(&scene, 0.5), 1),
        ("kicks x 2", kicks(&scene, 2.0), 1),
        ("100 blocks", blocks(100), 1),
        ("1000 blocks", blocks(1000), 1),
        ("friction 0", contact(0.0, 0.0), 1),
        ("friction 1", contact(0.0, 1.0), 1),
        ("restitution 0.5", contact(0.5, 0.2), 1),
        ("restitution 0.9", contact(0.9, 0.2), 1),
        ("drag 0.1 s^-1", drag(0.1), 1),
        ("drag 0.5 s^-1", drag(0.5), 1),
        ("drag 5 s^-1", drag(5.0), 1),
    ]
}

struct Seen {
    /// Root mean square speed \[block lengths / tick\].
    rms: f64,
    /// Number of collisions per block and tick, for blocks farther than [`APART`] from ground and
    /// shell.
    meetings: f64,
}

fn observe(scene: &Scene, substeps: u32) -> Seen {
    let plate = Plate { width: 3, depth: 3 };
    let settings = Settings {
        substeps,
        ..Settings::new(Model::Rapier, 1)
    };
    let units = BlockUnits::from_scene(scene);
    let Some(Agitation::Kicks { speed: (_, most) }) = scene.agitation else {
        panic!("the scene is agitated");
    };
    let most = units.speed(most) * 1.001;
    let radius = (1.5 / std::f64::consts::PI * f64::from(scene.free.count)
        / Gas::from_scene(scene)
            .expect("there are free blocks")
            .density)
        .cbrt();
    let (mut square, mut count) = (0.0, 0.0);
    let (mut met, mut apart) = (0.0, 0.0);
    let mut dockings = Vec::new();
    for run in 0..RUNS {
        let mut world =
            RapierWorld::new(scene, &plate, &settings, 1, run).expect("the scene can be set up");
        let states = |world: &RapierWorld| -> Vec<_> {
            (0..world.count()).map(|id| world.state(id)).collect()
        };
        let mut before = states(&world);
        let mut meeting = vec![false; before.len()];
        for tick in 0..WARM_UP + TICKS {
            world.step(&mut dockings).expect("the scene is stable");
            if tick + 1 < WARM_UP {
                continue;
            }
            let now = states(&world);
            if tick < WARM_UP {
                before = now;
                continue;
            }
            for ((old, new), meeting) in before.iter().zip(&now).zip(&mut meeting) {
                square += new.velocity.norm_squared();
                count += 1.0;
                // The velocity has changed by more than a random impulse, and did not in the tick
                // before.
                let drag = units.rate(scene.drag.as_ref().map_or(0.0, |drag| drag.rate));
                let change = (new.velocity - old.velocity * (-drag).exp()).norm();
                let was = std::mem::replace(meeting, change > most);
                if new.position.z > APART && new.position.norm() < radius - APART {
                    apart += 1.0;
                    met += f64::from(u8::from(*meeting && !was));
                }
            }
            before = now;
        }
    }
    Seen {
        rms: (square / count).sqrt(),
        meetings: met / apart,
    }
}
