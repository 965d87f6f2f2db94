//! Tests tanks at their extremes: fluids, magnets that always attract, and suction.
use std::fmt::Write as _;

use stochc_compiler::scene::built_in;
use stochc_ir::scene::{Agitation, Arrangement, Bond, Enclosure, Flow, Fluid, Scene, Strength};
use stochc_ir::table::Plate;
use stochc_runtime::world::rapier::RapierWorld;
use stochc_runtime::world::rigid::RigidWorld;
use stochc_runtime::world::{SpatialWorld, World};

use super::{Fate, fate, middle, second_outcome};

const HEAD: &str = "
## Tanks

Each row is one change of a tank with six free blocks. A run has 600 ticks with four steps per tick. The tanks are:

- `magnet_tank` without a plate;
- *suction*: `suction_tank` with a plate of 3 x 3 seeds and an open face in its centre;
- *10 um*: cubes of 10 um in water.

| changed | `rigid` | `rapier` |
|---|---|---|
";

/// Bottom of the tank.
#[derive(Clone, Copy)]
enum Ground {
    Bare,
    Plate,
}

fn tank(change: impl FnOnce(&mut Scene)) -> (Ground, Scene) {
    let mut scene = built_in("magnet_tank").expect("a built-in scene");
    scene.free.count = 6;
    change(&mut scene);
    (Ground::Bare, scene)
}

fn stir(change: impl FnOnce(&mut f64, &mut f64)) -> (Ground, Scene) {
    tank(|scene| {
        if let Some(Flow::Stir(stir)) = &mut scene.flow {
            change(&mut stir.rate, &mut stir.radius);
        }
    })
}

fn eddies(strength: Strength, size: f64) -> (Ground, Scene) {
    tank(|scene| {
        if let Some(Agitation::Turbulence(turbulence)) = &mut scene.agitation {
            turbulence.strength = strength;
            turbulence.length = size;
        }
    })
}

fn fluid(density: Option<f64>, viscosity: Option<f64>) -> (Ground, Scene) {
    tank(|scene| {
        scene.fluid = Some(Fluid {
            density,
            viscosity,
            added_mass: None,
        })
    })
}

fn magnets(hold: f64, depth: f64) -> (Ground, Scene) {
    tank(|scene| {
        if let Some(Bond::Reject { magnets, .. }) = &mut scene.bond {
            magnets.hold *= hold;
            magnets.depth *= depth;
        }
    })
}

fn suction(change: impl FnOnce(&mut Scene)) -> (Ground, Scene) {
    let mut scene = built_in("suction_tank").expect("a built-in scene");
    scene.free.count = 6;
    change(&mut scene);
    (Ground::Plate, scene)
}

fn pump(change: impl FnOnce(&mut stochc_ir::scene::Pump)) -> (Ground, Scene) {
    suction(|scene| {
        if let Some(Bond::Suction { pump, .. }) = &mut scene.bond {
            change(pump);
        }
    })
}

/// Returns a pump of 5 kPa, with defaults for the resistances.
const fn few(opening: Option<f64>) -> stochc_ir::scene::Pump {
    stochc_ir::scene::Pump {
        head: 5e3,
        opening,
        supply: None,
        valve: None,
        passage: None,
    }
}

/// Returns a tank with cubes of 10 um in water.
fn small(temperature: f64, tick: f64) -> (Ground, Scene) {
    tank(|scene| {
        scene.tick = tick;
        (scene.block.side, scene.block.mass) = (1e-5, 1e-12);
        scene.free.arrangement = Arrangement::Uniform;
        scene.enclosure = Some(Enclosure::Sphere {
            radius: 5e-5,
            wall: 1e-7,
        });
        (scene.gravity, scene.flow) = (None, None);
        scene.fluid = Some(Fluid {
            density: None,
            viscosity: Some(1e-3),
            added_mass: None,
        });
        scene.agitation = Some(Agitation::Brownian { temperature });
        scene.bond = None;
    })
}

fn cases() -> Vec<(&'static str, (Ground, Scene))> {
    vec![
        ("nothing", tank(|_| ())),
        ("tick x 100", tank(|s| s.tick *= 100.0)),
        ("gravity x 1000", tank(|s| s.gravity = Some(9810.0))),
        ("blocks of 10 kg", tank(|s| s.block.mass = 10.0)),
        ("blocks of 1 g", tank(|s| s.block.mass = 1e-3)),
        ("fluid of 1e6 kg/m^3", fluid(Some(1e6), Some(0.06))),
        ("viscosity of 1e6 Pa s", fluid(Some(920.0), Some(1e6))),
        ("viscosity of 1e-9 Pa s", fluid(Some(920.0), Some(1e-9))),
        ("no density", fluid(None, Some(0.06))),
        ("no viscosity", fluid(Some(920.0), None)),
        ("ring x 1000 as fast", stir(|rate, _| *rate *= 1000.0)),
        ("ring of 1 um", stir(|_, radius| *radius = 1e-6)),
        ("eddies of 100 m/s", eddies(Strength::Speed(100.0), 0.16)),
        ("eddies of 10 um", eddies(Strength::Intensity(0.03), 1e-5)),
        ("eddies of 1 km", eddies(Strength::Intensity(0.03), 1e3)),
        ("magnets x 1e6", magnets(1e6, 1.0)),
        ("magnets x 1e-6", magnets(1e-6, 1.0)),
        ("dipoles 1 um deep", magnets(1.0, 1e-6 / 0.03)),
        ("dipoles 3 m deep", magnets(1.0, 100.0)),
        (
            "20 blocks on the circle",
            tank(|scene| scene.free.count = 20),
        ),
        (
            "a tank as wide as a block",
            tank(|scene| {
                scene.enclosure = Some(Enclosure::Sphere {
                    radius: 0.1,
                    wall: 200.0,
                });
            }),
        ),
        ("suction, nothing", suction(|_| ())),
        ("suction, head x 1e6", pump(|pump| pump.head *= 1e6)),
        (
            "suction, valves of 1e-9 Pa s/m^3",
            pump(|pump| pump.valve = Some(1e-9)),
        ),
        (
            "suction, no other resistance than 1e-9 Pa s/m^3",
            pump(|pump| {
                (pump.supply, pump.passage, pump.valve) = (Some(0.0), Some(0.0), Some(1e-9));
            }),
        ),
        ("suction, only the head", pump(|pump| *pump = few(None))),
        (
            "suction, only the head and openings of 1 um",
            pump(|pump| *pump = few(Some(1e-6))),
        ),
        (
            "suction, only the head and openings of 1 km",
            pump(|pump| *pump = few(Some(1e3))),
        ),
        (
            "suction, jets of 1 um",
            suction(|scene| {
                if let Some(Flow::Jets(jets)) = &mut scene.flow {
                    jets.nozzle = 1e-6;
                }
            }),
        ),
        ("10 um at 293 K, ticks of 1 s", small(293.0, 1.0)),
        ("10 um at 293 K, ticks of 1 us", small(293.0, 1e-6)),
        ("10 um at 293 K, ticks of an hour", small(293.0, 3600.0)),
        ("10 um at 1e9 K", small(1e9, 1.0)),
        ("10 um at 1e-9 K", small(1e-9, 1.0)),
    ]
}

fn simulated_fate<W: SpatialWorld>(ground: Ground, scene: &Scene) -> Fate {
    let size = match ground {
        Ground::Bare => 0,
        Ground::Plate => 3,
    };
    let plate = Plate {
        width: size,
        depth: size,
    };
    fate::<W>(scene, &plate, 4, 600, |world: &mut W| match ground {
        Ground::Bare => {}
        Ground::Plate => World::magnetize(world, middle()),
    })
}

/// Writes the rows to the page. Returns the scenes that reached an invalid state.
pub fn table(page: &mut String) -> Vec<String> {
    page.push_str(HEAD);
    let mut unsound = Vec::new();
    for (name, (ground, scene)) in cases() {
        let rigid = simulated_fate::<RigidWorld>(ground, &scene);
        let rapier = simulated_fate::<RapierWorld>(ground, &scene);
        let rapier = second_outcome(&rigid, &rapier);
        writeln!(page, "| {name} | {rigid} | {rapier} |").unwrap();
        if let Fate::Invalid(what) = &rigid {
            unsound.push(format!("{name}: {what}"));
        }
    }
    unsound
}
