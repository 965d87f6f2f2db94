//! Measures the overlaps of blocks of a built-in scene with each other, the ground and the shell.
//!
//! Arguments: `[SCENE [SUBSTEPS [TICKS [NAME=FACTOR...]]]]`.
//!
//! No face is magnetized. An encounter begins when the centres of two free blocks are closer than
//! 1.2 block lengths. At smaller distances, most cubes touch. The encounter ends at a distance of
//! 1.8. If the centres come closer than half a block length, the blocks have passed through each
//! other. Rigid cubes stay a whole block length apart.
use std::collections::HashMap;

use nalgebra::Vector3;
use stochc_compiler::scene::built_in;
use stochc_ir::scene::dimensionless::BlockUnits;
use stochc_ir::scene::{Agitation, ContactLaw, Enclosure, Scene};
use stochc_ir::table::Plate;
use stochc_runtime::world::rigid::RigidWorld;
use stochc_runtime::world::{SpatialWorld as _, World as _};
use stochc_runtime::{Settings, Substeps};

/// Number of ticks until blocks that start at rest have reached their speed.
const WARM_UP: usize = 1_000;
/// Distance of two centres at the start of an encounter \[block lengths\].
const NEAR: f64 = 1.2;
/// Distance of two centres at the end of an encounter \[block lengths\].
const APART: f64 = 1.8;
/// Distance of two centres below which the blocks pass through each other \[block lengths\].
const PASSED: f64 = 0.5;

#[derive(Default)]
struct Counts {
    blocks: u64,
    below: u64,
    outside: u64,
    close: u64,
    encounters: u64,
    passed: u64,
    squares: f64,
}

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let arg = |i: usize, otherwise: &str| args.get(i).cloned().unwrap_or(otherwise.to_owned());
    let name = arg(0, "hemisphere");
    let (Some(mut scene), Ok(steps), Ok(ticks)) = (
        built_in(&name),
        arg(1, &Substeps::DEFAULT.to_string()).parse::<Substeps>(),
        arg(2, "20000").parse::<usize>(),
    ) else {
        eprintln!("overlap [SCENE [SUBSTEPS [TICKS [NAME=FACTOR...]]]]");
        return;
    };
    for change in args.iter().skip(3) {
        let read = change.split_once('=');
        let Some((number, Ok(factor))) = read.map(|(name, factor)| (name, factor.parse::<f64>()))
        else {
            eprintln!("write `stiffness=2`, not `{change}`");
            return;
        };
        scale(&mut scene, number, factor);
    }
    let settings = Settings::default().with_steps(steps);
    let seen = observe(&scene, &settings, ticks);
    let share = |part: u64, of: u64| part as f64 / of.max(1) as f64;
    println!("{name}, {steps} steps a tick, {ticks} ticks");
    let rms = (seen.squares / seen.blocks as f64).sqrt();
    println!("rms speed, sides a tick                      {rms:.4}");
    println!(
        "centres below 0.4 sides over the ground      {:.2e} of the time",
        share(seen.below, seen.blocks)
    );
    println!(
        "more than half a side outside of the shell   {:.2e} of the blocks",
        share(seen.outside, seen.blocks)
    );
    println!(
        "pairs with centres closer than a side        {:.2} at any time",
        share(seen.close, ticks as u64)
    );
    println!(
        "encounters with blocks that passed           {:.2e} ({} of {})",
        share(seen.passed, seen.encounters),
        seen.passed,
        seen.encounters
    );
}

/// Multiplies a scene parameter by a factor.
fn scale(scene: &mut Scene, number: &str, factor: f64) {
    let contact = scene.contact.as_mut().expect("blocks touch");
    match (number, &mut contact.law) {
        ("stiffness", ContactLaw::Compliant { stiffness, damping }) => {
            *stiffness *= factor;
            // The damping ratio stays the same, and therefore the restitution.
            *damping *= factor.sqrt();
        }
        ("friction", _) => contact.friction *= factor,
        ("kicks", _) => {
            if let Some(Agitation::Kicks { speed }) = &mut scene.agitation {
                speed.1 *= factor;
            }
        }
        ("wall", _) => {
            if let Some(Enclosure::Hemisphere { wall, .. }) = &mut scene.enclosure {
                *wall *= factor;
            }
        }
        _ => eprintln!("`{number}` is none of stiffness, friction, kicks, wall"),
    }
}

fn observe(scene: &Scene, settings: &Settings, ticks: usize) -> Counts {
    let radius = match &scene.enclosure {
        Some(Enclosure::Hemisphere { radius, .. }) => BlockUnits::from_scene(scene).length(*radius),
        _ => f64::INFINITY,
    };
    let plate = Plate { width: 3, depth: 3 };
    let mut world = RigidWorld::new(scene, &plate, settings, 1, 0).expect("the scene can be");
    let mut none = Vec::new();
    let mut counts = Counts::default();
    // Smallest distance of each pair during its encounter.
    let mut encounters: HashMap<(u32, u32), f64> = HashMap::new();
    for tick in 0..WARM_UP + ticks {
        world.step(&mut none).expect("the scene can be computed");
        if tick < WARM_UP {
            continue;
        }
        let states: Vec<_> = (0..world.count()).map(|id| world.state(id)).collect();
        let places: Vec<Vector3<f64>> = states.iter().map(|state| state.position).collect();
        counts.blocks += places.len() as u64;
        counts.squares += (states.iter())
            .map(|state| state.velocity.norm_squared())
            .sum::<f64>();
        counts.below += places.iter().filter(|place| place.z < 0.4).count() as u64;
        counts.outside += places
            .iter()
            .filter(|place| place.norm() > radius + 0.5)
            .count() as u64;
        for (a, b) in near_pairs(&places) {
            let distance = (places[a as usize] - places[b as usize]).norm();
            counts.close += u64::from(distance < 1.0);
            let nearest = encounters.entry((a, b)).or_insert(distance);
            *nearest = nearest.min(distance);
        }
        encounters.retain(|&(a, b), nearest| {
            let continues = (places[a as usize] - places[b as usize]).norm() < APART;
            counts.encounters += u64::from(!continues);
            counts.passed += u64::from(!continues && *nearest < PASSED);
            continues
        });
    }
    counts
}

/// Returns the pairs whose centres are closer than [`NEAR`].
fn near_pairs(places: &[Vector3<f64>]) -> Vec<(u32, u32)> {
    let mut order: Vec<u32> = (0..places.len() as u32).collect();
    order.sort_by(|&a, &b| places[a as usize].x.total_cmp(&places[b as usize].x));
    let mut pairs = Vec::new();
    for (i, &a) in order.iter().enumerate() {
        let near = order[i + 1..]
            .iter()
            .take_while(|&&b| places[b as usize].x - places[a as usize].x < NEAR);
        pairs.extend(
            near.filter(|&&b| (places[a as usize] - places[b as usize]).norm() < NEAR)
                .map(|&b| (a.min(b), a.max(b))),
        );
    }
    pairs
}
