//! Measures how the cost of a tick grows with blocks, magnetized faces and structure.
//!
//! Uses the default scene at its density, with the model `rigid` and one step per tick. Memory is
//! the additional resident memory of the process (Linux).
use std::time::Instant;

use nalgebra::Vector3;
use stochc_compiler::scene::built_in;
use stochc_ir::scene::{Bond, Enclosure, Scene};
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};
use stochc_runtime::world::rigid::RigidWorld;
use stochc_runtime::world::{BlockFace, Body, BodyState, SpatialWorld as _, World as _};
use stochc_runtime::{Model, Settings};

const SIZES: [u32; 5] = [100, 1_000, 10_000, 100_000, 1_000_000];

/// Number of free blocks when many faces or a large structure are measured. This number of blocks
/// costs almost nothing.
const FEW: u32 = 1;

/// Number of blocks that are captured at the same time while a structure is set up.
const AT_ONCE: usize = 1000;

/// Number of ticks until the motion of the blocks is stationary.
const WARM_UP: u64 = 300;

fn main() {
    let only = std::env::args().nth(1).unwrap_or_default();
    let report = |what: &str, make: &dyn Fn(u32) -> Option<RigidWorld>| {
        if what.contains(&only) {
            report(what, make);
        }
    };
    report("free blocks", &|count| Some(setting(count, 3).1));
    report("magnetized faces", &|count| {
        let (side, mut world) = setting(FEW, count.isqrt() + 1);
        seats(side, count).for_each(|(site, _)| world.magnetize(site));
        Some(world)
    });
    report("anchored blocks", &|count| {
        let (side, mut world) = setting(FEW + count, count.isqrt() + 1);
        let seats: Vec<_> = (0..).zip(seats(side, count)).collect();
        let mut dockings = Vec::new();
        for some in seats.chunks(AT_ONCE) {
            for &(id, (site, seat)) in some {
                world.magnetize(site);
                world.set_state(id, &BodyState::at_rest(seat));
            }
            world.step(&mut dockings).ok()?;
        }
        (dockings.len() == count as usize).then_some(world)
    });
}

/// Prints a table with the cost at each size, and the exponent of its growth from the previous
/// size.
#[expect(clippy::disallowed_methods, reason = "it measures time")]
fn report(what: &str, make: &dyn Fn(u32) -> Option<RigidWorld>) {
    println!("\n| {what} | a tick | each | exponent | memory of each |");
    println!("|---:|---:|---:|---:|---:|");
    let mut before: Option<f64> = None;
    for count in SIZES {
        let held = resident();
        let Some(mut world) = make(count) else {
            println!("| {count} | could not be set up | | | |");
            continue;
        };
        let mut none = Vec::new();
        let ticks = (5_000_000 / u64::from(count)).clamp(10, 5000);
        for _ in 0..WARM_UP {
            world.step(&mut none).expect("the physics is stable");
        }
        let start = Instant::now();
        for _ in 0..ticks {
            world.step(&mut none).expect("the physics is stable");
        }
        let tick = start.elapsed().as_secs_f64() / ticks as f64;
        let each = f64::from(count);
        let exponent = before.map_or_else(String::new, |b| format!("{:.2}", (tick / b).log10()));
        let memory = match (held, resident()) {
            (Some(held), Some(now)) if count >= 10_000 => {
                format!("{:.0} B", (now.saturating_sub(held)) as f64 / each)
            }
            _ => String::new(),
        };
        println!(
            "| {count} | {:.3} ms | {:.0} ns | {exponent} | {memory} |",
            tick * 1e3,
            tick * 1e9 / each
        );
        before = Some(tick);
    }
}

/// Returns the number of blocks and a world with `count` blocks above a square plate. The plate has
/// `side` seeds along each edge.
fn setting(count: u32, side: u32) -> (u32, RigidWorld) {
    let mut scene: Scene = built_in("hemisphere_soft").expect("a built-in scene");
    scene.free.count = count;
    if let Some(Enclosure::Hemisphere { radius, .. }) = &mut scene.enclosure {
        let plate = f64::from(side) * scene.block.side;
        *radius = (*radius * (f64::from(count) / 300.0).cbrt()).max(plate);
    }
    // The larger tolerance ensures that a block is captured at its position in spite of random
    // impulses.
    if let Some(Bond::Attract { anchor, .. }) = &mut scene.bond {
        anchor.within = 0.1 * scene.block.side;
    }
    let plate = Plate {
        width: side,
        depth: side,
    };
    let world = RigidWorld::new(&scene, &plate, &Settings::new(Model::Rigid, 1), 1, 0);
    (side, world.expect("a valid scene"))
}

/// Returns upper faces of the plate, each with the position of the block that it captures.
fn seats(side: u32, count: u32) -> impl Iterator<Item = (BlockFace, Vector3<f64>)> {
    (0..count).map(move |i| {
        // The world stores faces in this order.
        let (x, y) = (i / side, i % side);
        let at = |x: u32| f64::from(x) - f64::from(side - 1) / 2.0;
        let body = Body::Seed(Cell::new(x as i32, y as i32, 0));
        let site = BlockFace {
            body,
            face: Face::Up,
        };
        (site, Vector3::new(at(x), at(y), 0.5))
    })
}

/// Returns the resident memory of the process \[bytes\].
#[expect(clippy::disallowed_methods, reason = "it measures memory")]
fn resident() -> Option<usize> {
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(pages.split(' ').nth(1)?.parse::<usize>().ok()? * 4096)
}
