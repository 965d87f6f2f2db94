//! Compares the scene `hemisphere_2005` with the predictions of kinetic theory.
//!
//! Blocks have a number density n and a mean speed v. They enter the reach of a magnetized face n v
//! A / 4 times per tick. A is the surface of all positions of a block whose nearest face just
//! enters the reach. It is averaged over orientations, without the positions that the structure
//! blocks. Compare the prediction with the entry rates of `stochc simulate --captures`.
use nalgebra::{UnitQuaternion, UnitVector3, Vector3};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use stochc_compiler::scene::built_in;
use stochc_ir::scene::{Bond, Enclosure, Scene};
use stochc_ir::table::Plate;
use stochc_runtime::world::rapier::RapierWorld;
use stochc_runtime::world::{SpatialWorld as _, World as _};
use stochc_runtime::{Model, Settings};

/// Number of random directions and orientations for estimating an area.
const SAMPLES: usize = 400_000;
/// Number of ticks until blocks that start at rest have reached their speed.
const WARM_UP: usize = 2_000;
/// Number of observed ticks in each of [`RUNS`] runs.
const TICKS: usize = 4_000;
const RUNS: u64 = 4;
/// Height below which a block counts as near the ground \[block lengths\].
const NEAR: f64 = 1.5;

fn main() {
    let scene = built_in("hemisphere_2005").expect("a built-in scene");
    let side = scene.block.side;
    let (Some(Bond::Attract { pull, .. }), Some(Enclosure::Hemisphere { radius, .. })) =
        (&scene.bond, &scene.enclosure)
    else {
        panic!("the default scene has a magnet and an enclosure");
    };
    let (reach, radius) = (pull.within / side, radius / side);
    let gas = observe(&scene);
    let volume = 2.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
    let density = f64::from(scene.free.count) / volume;
    let near = gas.near / (std::f64::consts::PI * radius.powi(2) * (NEAR - 0.5));
    println!("mean speed            {:.4} m a tick", gas.speed * side);
    println!(
        "mean speed near ground{:.4} m a tick",
        gas.speed_near * side
    );
    println!("density, mean         {:.3} / m^3", density / side.powi(3));
    println!("density near ground   {:.3} / m^3", near / side.powi(3));
    let tower = area(reach, overlaps_column);
    let plate = area(reach, |centre, rotation| lowest(centre, rotation) < 0.0);
    let rate = |area: f64, density: f64, speed: f64| density * speed * area / 4.0;
    println!("area of a tower's top {:.3} m^2", tower * side * side);
    println!("area of a plate face  {:.3} m^2", plate * side * side);
    println!(
        "entries a tick, tower {:.5}",
        rate(tower, density, gas.speed)
    );
    println!(
        "entries a tick, plate {:.5}",
        rate(plate, density, gas.speed)
    );
    println!(
        "entries a tick, plate {:.5} with the values near the ground",
        rate(plate, near, gas.speed_near)
    );
}

struct Gas {
    /// Mean speed \[block lengths / tick\].
    speed: f64,
    /// Mean speed of the blocks whose centre is lower than [`NEAR`] \[block lengths / tick\].
    speed_near: f64,
    /// Mean number of the blocks whose centre is lower than [`NEAR`].
    near: f64,
}

/// Observes the free blocks of the scene while no face is magnetized.
fn observe(scene: &Scene) -> Gas {
    let plate = Plate { width: 3, depth: 3 };
    let (mut sum, mut count) = (0.0, 0.0);
    let (mut sum_near, mut count_near) = (0.0, 0.0);
    let mut samples = 0.0;
    let mut dockings = Vec::new();
    for run in 0..RUNS {
        let mut world = RapierWorld::new(scene, &plate, &Settings::new(Model::Rapier, 1), 1, run)
            .expect("the default scene fits");
        for tick in 0..WARM_UP + TICKS {
            world
                .step(&mut dockings)
                .expect("the default scene is stable");
            if tick < WARM_UP || tick % 10 > 0 {
                continue;
            }
            samples += 1.0;
            for id in 0..world.count() {
                let state = world.state(id);
                let speed = state.velocity.norm();
                sum += speed;
                count += 1.0;
                if state.position.z < NEAR {
                    sum_near += speed;
                    count_near += 1.0;
                }
            }
        }
    }
    Gas {
        speed: sum / count,
        speed_near: sum_near / count_near,
        near: count_near / samples,
    }
}

/// Returns the area of all positions of a cube whose nearest face is just within `reach` of the
/// origin \[square block lengths\]. The area is averaged over orientations. The face at the origin
/// points up. Positions that `barred` accepts are left out.
fn area(reach: f64, barred: impl Fn(Vector3<f64>, &UnitQuaternion<f64>) -> bool) -> f64 {
    let mut dice = ChaCha8Rng::seed_from_u64(1);
    let mut open = 0usize;
    for _ in 0..SAMPLES {
        let rotation = orientation(&mut dice);
        let outward = direction(&mut dice);
        // The centre is on one of six spheres, one for each face of the cube. If the cube were at a
        // sphere's centre, the face of this sphere would be at the origin.
        let face = rotation * Vector3::z() * 0.5;
        let centre = outward.into_inner() * reach - face;
        let nearest = [Vector3::x(), Vector3::y(), Vector3::z()]
            .iter()
            .flat_map(|axis| [axis * 0.5, axis * -0.5])
            .map(|face| (centre + rotation * face).norm())
            .fold(f64::MAX, f64::min);
        open += usize::from(nearest > reach * (1.0 - 1e-9) && !barred(centre, &rotation));
    }
    6.0 * 4.0 * std::f64::consts::PI * reach * reach * open as f64 / SAMPLES as f64
}

fn direction(dice: &mut ChaCha8Rng) -> UnitVector3<f64> {
    loop {
        let point = Vector3::from_fn(|_, _| dice.random_range(-1.0..1.0));
        if (1e-3..1.0).contains(&point.norm()) {
            return UnitVector3::new_normalize(point);
        }
    }
}

/// Returns a random rotation, uniformly distributed (Shoemake's method).
fn orientation(dice: &mut ChaCha8Rng) -> UnitQuaternion<f64> {
    let (u, v, w): (f64, f64, f64) = (dice.random(), dice.random(), dice.random());
    let turn = std::f64::consts::TAU;
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    UnitQuaternion::new_normalize(nalgebra::Quaternion::new(
        a * (turn * v).sin(),
        a * (turn * v).cos(),
        b * (turn * w).sin(),
        b * (turn * w).cos(),
    ))
}

/// Returns the height of the lowest point of a unit cube.
fn lowest(centre: Vector3<f64>, rotation: &UnitQuaternion<f64>) -> f64 {
    let axes = rotation.to_rotation_matrix().into_inner();
    centre.z - 0.5 * axes.row(2).abs().sum()
}

/// Returns whether a unit cube overlaps the square column below the origin, by separating axes.
fn overlaps_column(centre: Vector3<f64>, rotation: &UnitQuaternion<f64>) -> bool {
    const DEPTH: f64 = 20.0;
    let half = Vector3::new(0.5, 0.5, DEPTH / 2.0);
    let offset = centre - Vector3::new(0.0, 0.0, -DEPTH / 2.0);
    let cube = rotation.to_rotation_matrix().into_inner();
    let frame = [Vector3::x(), Vector3::y(), Vector3::z()];
    let own: Vec<Vector3<f64>> = (0..3).map(|i| cube.column(i).into_owned()).collect();
    let crossed = frame
        .iter()
        .flat_map(|a| own.iter().map(move |b| a.cross(b)));
    frame
        .into_iter()
        .chain(own.iter().copied())
        .chain(crossed)
        .all(|axis| {
            let length = axis.norm();
            if length < 1e-9 {
                return true;
            }
            let axis = axis / length;
            let column = axis.abs().dot(&half);
            let block: f64 = own.iter().map(|edge| 0.5 * edge.dot(&axis).abs()).sum();
            offset.dot(&axis).abs() < column + block
        })
}
