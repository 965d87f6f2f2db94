//! Tests steps that are smaller than the last digit of a position.
use std::fmt::Write as _;

use nalgebra::Vector3;
use stochc_ir::scene::{Agitation, Anchor, BOLTZMANN, Bond, Fluid, Magnets, Measure, Scene};
use stochc_runtime::world::rapier::RapierWorld;
use stochc_runtime::world::rigid::RigidWorld;
use stochc_runtime::world::{BodyState, SpatialWorld, World};
use stochc_runtime::{Model, Precision, Settings};

use crate::scenes::{Dice, PLATE, empty};

const BLOCKS: usize = 400;
const TICKS: u64 = 2000;

/// Returns cubes `far` block lengths from the plate with random orientations and thermal speeds, in
/// block units.
fn blocks(far: f64, [speed, spin]: [f64; 2]) -> Vec<BodyState> {
    let mut dice = Dice::new(1);
    let mut position = |_| {
        let orientation = dice.rotation();
        BodyState {
            orientation,
            velocity: speed * dice.direction(),
            spin: spin * dice.direction(),
            ..BodyState::at_rest(far * dice.direction())
        }
    };
    (0..BLOCKS).map(&mut position).collect()
}

/// Brownian motion of 400 cubes of 10 um.
struct Brownian {
    /// Mean squared displacement divided by Einstein's prediction.
    displacement: f64,
    /// Mean squared rotation divided by its prediction.
    turn: f64,
}

fn brownian<W: SpatialWorld>(tick: f64, far: f64, settings: &Settings) -> Brownian {
    let (temperature, viscosity, mut scene) = (293.0, 1e-3, empty());
    scene.tick = tick;
    (scene.block.side, scene.block.mass) = (1e-5, 1e-12);
    scene.fluid = Some(Fluid {
        density: None,
        viscosity: Some(viscosity),
        added_mass: None,
    });
    scene.agitation = Some(Agitation::Brownian { temperature });
    let scene: Scene = scene;
    let (side, mass, time) = (scene.block.side, scene.block.mass, tick * TICKS as f64);
    let inertia = mass * side * side / 6.0;
    let fast = |inertia: f64| (3.0 * BOLTZMANN * temperature / inertia).sqrt() * tick;
    let blocks = blocks(far, [fast(mass) / side, fast(inertia)]);
    let mut world = W::with_blocks(&scene, &PLATE, settings, 1, 0, &blocks).expect("a valid scene");
    let states =
        |world: &W| -> Vec<BodyState> { (0..world.count()).map(|id| world.state(id)).collect() };
    let mut none = Vec::new();
    let start = states(&world);
    for _ in 0..TICKS {
        world.step(&mut none).expect("the physics is stable");
    }
    let end = states(&world);
    let mean_square = |of: fn(&BodyState, &BodyState) -> f64| {
        let squares = start.iter().zip(&end).map(|(a, b)| of(a, b).powi(2));
        squares.sum::<f64>() / BLOCKS as f64
    };
    // Exact ratio for a velocity with this friction and inertia.
    let exact = |friction: f64, inertia: f64| {
        let rate = friction / inertia;
        6.0 * BOLTZMANN * temperature / friction * (time + ((-rate * time).exp() - 1.0) / rate)
    };
    let displacement = mean_square(|a, b| (a.position - b.position).norm()) * side * side;
    let turn = mean_square(|a, b| a.orientation.angle_to(&b.orientation));
    Brownian {
        displacement: displacement / exact(Fluid::friction(viscosity, side), mass),
        turn: turn / exact(Fluid::turning_friction(viscosity, side), inertia),
    }
}

/// A position stores displacements below its last digit. This also holds for a moving group.
#[test]
fn a_bonded_pair_sinks_at_any_speed() {
    let speed = 1e-5;
    let mut scene = Scene {
        gravity: Some(speed),
        fluid: Some(Fluid {
            density: None,
            viscosity: Some(1.0 / Fluid::friction(1.0, 1.0)),
            added_mass: None,
        }),
        ..empty()
    };
    scene.bond = Some(Bond::Reject {
        magnets: Magnets {
            hold: 0.1,
            depth: 0.2,
            within: 1.5,
        },
        anchor: Anchor {
            measure: Measure::Centres,
            within: 0.05,
            tilt: 0.25,
            sampled: false,
        },
        impulse: 0.0,
    });
    let blocks = [-0.5, 0.5].map(|x| BodyState::at_rest(Vector3::new(x, 0.0, 600.0)));
    let settings = Settings::new(Model::Rigid, 1);
    let mut world =
        RigidWorld::with_blocks(&scene, &PLATE, &settings, 1, 0, &blocks).expect("a valid scene");
    for _ in 0..3000 {
        world.step(&mut Vec::new()).expect("the physics is stable");
    }
    assert_eq!(world.groups(), [[0, 1]]);
    for id in 0..2 {
        let sunk = 600.0 - world.state(id).position.z;
        assert!((sunk / (speed * 3000.0) - 1.0).abs() < 0.01, "{sunk}");
    }
}

/// Writes the tables to the page. Returns the deviations of the kernel `rigid`.
pub fn tables(page: &mut String) -> Vec<String> {
    let mut off = Vec::new();
    page.push_str(
        "
## Rounding errors

If blocks move very little per step, rounding errors can stop them. The test simulates 400 cubes of 10 um in water at 293 K for 2,000
ticks, without collisions. The table lists their diffusion coefficient divided by the coefficient of Einstein's relation. The uncertainty is
4 %. **With `rapier`, blocks far from the plate hardly diffuse.**

| tick, distance from the plate [block lengths] | `rigid` | `rigid`, double precision | `rapier` |
|---|--:|--:|--:|
",
    );
    for (name, tick, far) in [
        ("1 us, 6", 1e-6, 6.0),
        ("1 us, 600", 1e-6, 600.0),
        ("0.1 us, 600", 1e-7, 600.0),
        ("0.1 us, 60,000", 1e-7, 60_000.0),
    ] {
        let found = in_all(tick, far).map(|it| it.displacement);
        row(page, name, found);
        // 1,200 independent squares have a standard error of 4.1 %; the limit is three of these.
        if found[..2].iter().any(|part| (part - 1.0).abs() > 0.12) {
            off.push(format!("{name}: {found:?}"));
        }
    }
    page.push_str(
        "
The next table lists the same ratio for rotation, six block lengths from the plate. **Rotation is too slow** if a block turns by less than
3e-7 radians per step (`rigid`, single precision) or 3e-6 radians (`rapier`). stochc warns of such scenes. Use `--precision double` for them.

| tick, turn per step [rad] | `rigid` | `rigid`, double precision | `rapier` |
|---|--:|--:|--:|
",
    );
    for (name, tick) in [
        ("1 us, 3e-5", 1e-6),
        ("0.1 us, 3e-6", 1e-7),
        ("0.01 us, 3e-7", 1e-8),
        ("0.003 us, 8e-8", 3e-9),
        ("0.001 us, 3e-8", 1e-9),
    ] {
        let found = in_all(tick, 6.0).map(|it| it.turn);
        row(page, name, found);
        if (found[1] - 1.0).abs() > 0.12 {
            off.push(format!("{name}: {found:?}"));
        }
        // Both runs draw the same random numbers, so only rounding makes them differ.
        let is_held = found[0] < 0.95 * found[1];
        if is_held != (tick < 1e-8) {
            off.push(format!("{name}: {found:?}, held by digits: {is_held}"));
        }
    }
    off
}

fn in_all(tick: f64, far: f64) -> [Brownian; 3] {
    let single = Settings::new(Model::Rigid, 1);
    let double = Settings {
        precision: Precision::Double,
        ..single.clone()
    };
    [
        brownian::<RigidWorld>(tick, far, &single),
        brownian::<RigidWorld>(tick, far, &double),
        brownian::<RapierWorld>(tick, far, &single),
    ]
}

fn row(page: &mut String, name: &str, found: [f64; 3]) {
    let [one, two, other] = found.map(|part| 100.0 * part);
    writeln!(page, "| {name} | {one:.0} % | {two:.0} % | {other:.0} % |").expect("memory");
}
