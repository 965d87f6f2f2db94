//! Tests local steps: blocks near magnetized faces take short steps, all others long ones.
//!
//! Gases between mirrors surround an open face. Blocks enter and leave its field all the time, some
//! while they touch others. Crossing the border of the field must not change the physics.

use crate::scenes::{Kind, attract, compliant, empty, energy, pass, states, world};
use nalgebra::Vector3;
use stochc_ir::scene::Scene;
use stochc_ir::{Cell, Face};
use stochc_runtime::Settings;
use stochc_runtime::world::{BlockFace, Body, BodyState, SpatialWorld, World};

in_either_precision!(
    as_many_long_steps_as_short_ones_are_uniform_steps,
    momentum_is_kept_across_the_border,
    energy_is_kept_across_the_border,
    a_face_sees_the_same_gas_as_with_short_steps_everywhere,
);

const MIDDLE: Vector3<f64> = Vector3::new(0.0, 0.0, 0.5);
const RADIUS: f64 = 4.5;
const BLOCKS: usize = 16;

fn gas(seed: u64, speed: f64) -> Vec<BodyState> {
    // The ball is around the middle of the plate, whose upper face is the only one that attracts.
    crate::scenes::gas(BLOCKS, seed, (MIDDLE, RADIUS), 1.8, speed)
}

fn steps<K: Kind>(away: u32, near: u32) -> Settings {
    Settings {
        away: Some(away),
        ..K::with_substeps(near)
    }
}

/// Returns a gas of blocks that pass through the plate, around a face with this pull that never
/// captures.
fn scene(pull: f64, stiffness: f64, damping: f64) -> Scene {
    Scene {
        contact: compliant(stiffness, damping, 0.0),
        bond: attract(pull, 0.0),
        ..empty()
    }
}

fn open<K: Kind>(scene: &Scene, settings: &Settings, blocks: &[BodyState]) -> K::World {
    let mut world: K::World = world(scene, settings, blocks);
    let (body, face) = (Body::Seed(Cell::new(1, 1, 0)), Face::Up);
    world.magnetize(BlockFace { body, face });
    world
}

/// Reverses the radial velocity of each block that leaves the ball.
fn mirror(world: &mut impl SpatialWorld) {
    for id in 0..world.count() {
        let mut block = world.state(id);
        let out = (block.position - MIDDLE).normalize();
        let away = block.velocity.dot(&out);
        if (block.position - MIDDLE).norm() > RADIUS && away > 0.0 {
            block.velocity -= 2.0 * away * out;
            world.set_state(id, &block);
        }
    }
}

/// Negligible pull, which isolates the effect of the border.
const NOTHING: f64 = 1e-12;

fn as_many_long_steps_as_short_ones_are_uniform_steps<K: Kind>() {
    let (scene, blocks) = (scene(0.01, 0.1, 0.1), gas(1, 0.1));
    let run = |settings: &Settings| {
        let mut world = open::<K>(&scene, settings, &blocks);
        pass(&mut world, 100);
        states(&world)
    };
    assert_eq!(run(&steps::<K>(4, 4)), run(&K::with_substeps(4)));
    assert_ne!(run(&steps::<K>(1, 4)), run(&K::with_substeps(4)));
}

fn momentum_is_kept_across_the_border<K: Kind>() {
    let mut world = open::<K>(&scene(NOTHING, 0.05, 0.02), &steps::<K>(1, 8), &gas(2, 0.1));
    let momentum = |world: &K::World| {
        states(world)
            .iter()
            .map(|b| b.velocity)
            .sum::<Vector3<f64>>()
    };
    let mut bounced = 0;
    for _ in 0..2000 {
        let (before, start) = (momentum(&world), states(&world));
        pass(&mut world, 1);
        let change = (momentum(&world) - before).norm();
        // The plate also absorbs momentum, so ticks with a contact with it are left out.
        let touches = |b: &BodyState| b.position.z < 0.9 && b.position.z > -1.9;
        let aside = |b: &BodyState| b.position.x.abs().max(b.position.y.abs()) < 2.5;
        if !states(&world)
            .iter()
            .chain(&start)
            .any(|b| touches(b) && aside(b))
        {
            assert!(
                change < 100.0 * BLOCKS as f64 * 0.1 * K::ROUNDING,
                "{change}"
            );
            let changed = |(a, b): (&BodyState, &BodyState)| a.velocity != b.velocity;
            bounced += usize::from(states(&world).iter().zip(&start).any(changed));
        }
        mirror(&mut world);
    }
    assert!(bounced > 20, "{bounced}");
}

/// Compares the energies of undamped gases with the energies in simulations with uniform steps,
/// averaged over gases. The springs are soft enough for long steps, so any deviation comes from the
/// border.
fn energy_is_kept_across_the_border<K: Kind>() {
    let late = |settings: &Settings, seed| {
        let mut world = open::<K>(&scene(NOTHING, 0.003, 0.0), settings, &gas(seed, 0.03));
        let heat = |world: &K::World| states(world).iter().map(energy).sum::<f64>();
        let (first, mut late) = (heat(&world), 0.0);
        for tick in 0..5000 {
            pass(&mut world, 1);
            mirror(&mut world);
            if tick >= 4000 {
                late += heat(&world) / first / 1000.0;
            }
        }
        late
    };
    let mean = |settings: &Settings| (1..=8).map(|seed| late(settings, seed)).sum::<f64>() / 8.0;
    let [local, short, long] =
        [steps::<K>(1, 8), K::with_substeps(8), K::with_substeps(1)].map(|s| mean(&s));
    println!("energy: local {local}, short {short}, long {long}");
    assert!((local - short).abs() < 0.1, "{local} {short} {long}");
}

/// Compares local steps with short steps everywhere. The number of blocks in the field of a face,
/// their speed, and the rate of entries agree within chance.
fn a_face_sees_the_same_gas_as_with_short_steps_everywhere<K: Kind>() {
    let look = |settings: &Settings, seed| {
        let mut world = open::<K>(&scene(0.0003, 0.003, 0.0), settings, &gas(seed, 0.03));
        let (mut inside, mut speeds, ticks) = (0.0, 0.0, 8000);
        for _ in 0..ticks {
            pass(&mut world, 1);
            for (_, id, _) in world.in_reach() {
                inside += 1.0;
                speeds += world.state(id).velocity.norm();
            }
            mirror(&mut world);
        }
        let entries: u32 = world.active().iter().map(|(_, entries)| entries).sum();
        [
            inside / f64::from(ticks),
            speeds / inside,
            f64::from(entries),
        ]
    };
    let sample = |settings: &Settings| (1..=16).map(|seed| look(settings, seed)).collect();
    let [local, short]: [Vec<[f64; 3]>; 2] =
        [steps::<K>(1, 8), K::with_substeps(8)].map(|s| sample(&s));
    for what in 0..3 {
        let of = |sample: &[[f64; 3]]| {
            let n = sample.len() as f64;
            let mean = sample.iter().map(|x| x[what]).sum::<f64>() / n;
            let square = sample.iter().map(|x| (x[what] - mean).powi(2)).sum::<f64>();
            (mean, square / (n - 1.0) / n)
        };
        let ((a, da), (b, db)) = (of(&local), of(&short));
        println!("{what}: {a} {b} +- {}", (da + db).sqrt());
        assert!((a - b).abs() < 3.5 * (da + db).sqrt(), "{what}: {a} {b}");
    }
}
