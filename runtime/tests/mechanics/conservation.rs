//! What a closed gas keeps: momentum, angular momentum, energy.
//!
//! The blocks are kept together by a mirror that the test holds: who has left a ball gets the
//! radial part of the velocity turned round, which keeps its energy and, as the push is central,
//! the angular momentum of all about the middle of the ball.

use crate::scenes::{Double, Kind, Single, compliant, contact, empty, energy, pass, states};
use nalgebra::Vector3;
use stochc_ir::scene::{Contact, Scene};
use stochc_runtime::world::{Arena, BodyState};
use stochc_runtime::{Reduction, Settings};

in_every_kind!(
    colliding_blocks_keep_momentum_and_angular_momentum,
    inelastic_and_rough_collisions_never_add_energy,
);

mod kernel {
    use super::*;
    in_either_precision!(
        springs_without_damping_keep_energy,
        compliant_contacts_keep_angular_momentum_to_the_last_digits,
        elastic_collisions_keep_energy,
        elastic_balls_keep_energy,
    );
}

const MIDDLE: Vector3<f64> = Vector3::new(0.0, 0.0, 6.0);
const RADIUS: f64 = 4.0;

/// `count` blocks that move and turn anyhow, none touching another.
fn gas(count: usize, seed: u64) -> Vec<BodyState> {
    crate::scenes::gas(count, seed, (MIDDLE, RADIUS), 1.9, 0.05)
}

/// What changed in the worst tick, and in all of them.
#[derive(Debug, Default)]
struct Drift {
    momentum: f64,
    angular: f64,
    /// Part of the energy that was there.
    gain: f64,
    ticks_with_gain: usize,
    /// Energy at the end over that at the beginning.
    left: f64,
    /// The same, on average over the last thousand ticks.
    late: f64,
    /// Ticks in which some block changed its speed.
    collisions: usize,
}

fn angular(block: &BodyState) -> Vector3<f64> {
    (block.position - MIDDLE).cross(&block.velocity) + block.spin / 6.0
}

fn watch<K: Kind>(contact: Option<Contact>, count: usize, substeps: u32, ticks: u64) -> Drift {
    watch_with::<K>(contact, &gas(count, 7), &K::with_substeps(substeps), ticks)
}

fn watch_with<K: Kind>(
    contact: Option<Contact>,
    start: &[BodyState],
    settings: &Settings,
    ticks: u64,
) -> Drift {
    let scene = Scene { contact, ..empty() };
    let mut world: K::World = crate::scenes::world(&scene, settings, start);
    let total = |of: &dyn Fn(&BodyState) -> Vector3<f64>, all: &[BodyState]| {
        all.iter().map(of).sum::<Vector3<f64>>()
    };
    let heat = |all: &[BodyState]| all.iter().map(energy).sum::<f64>();
    let mut drift = Drift::default();
    let first = heat(start);
    let mut before = start.to_vec();
    for tick in 0..ticks {
        pass(&mut world, 1);
        let mut after = states(&world);
        if tick + 1000 >= ticks {
            drift.late += heat(&after) / first / 1000.0;
        }
        let change = |of: &dyn Fn(&BodyState) -> Vector3<f64>| {
            (total(of, &after) - total(of, &before)).norm()
        };
        drift.momentum = drift.momentum.max(change(&|b| b.velocity));
        drift.angular = drift.angular.max(change(&angular));
        let gain = (heat(&after) - heat(&before)) / first;
        drift.gain = drift.gain.max(gain);
        drift.ticks_with_gain += usize::from(gain > 1e-6);
        drift.collisions += usize::from(
            after
                .iter()
                .zip(&before)
                .any(|(a, b)| a.velocity != b.velocity),
        );
        for (id, block) in after.iter_mut().enumerate() {
            let out = block.position - MIDDLE;
            let away = block.velocity.dot(&out.normalize());
            if out.norm() > RADIUS && away > 0.0 {
                block.velocity -= 2.0 * away * out.normalize();
                world.set_state(id as u32, block);
                *block = world.state(id as u32);
            }
        }
        before = after;
    }
    drift.left = heat(&before) / first;
    drift
}

/// Every block changes several times a tick in a crowd, and rounds numbers of 0.1 each time.
fn rounding<K: Kind>() -> f64 {
    12.0 * BLOCKS as f64 * 0.1 * K::ROUNDING
}

const BLOCKS: usize = 12;

fn colliding_blocks_keep_momentum_and_angular_momentum<K: Kind>() {
    for (e, friction) in [(1.0, 0.0), (0.5, 0.3)] {
        for substeps in [1, 8] {
            let drift = watch::<K>(contact(e, friction), BLOCKS, substeps, 600);
            assert!(drift.collisions > 20, "{drift:?}");
            assert!(drift.momentum < rounding::<K>(), "{drift:?}");
            // Undoing an overlap moves blocks without giving them a velocity: a fifth of the depth, which
            // is at most what two blocks at 0.15 gain on each other in a substep, times that speed.
            // The reference feels a contact up to its margin of 0.1 apart, with impulses of 0.15.
            let moved = 0.2 * 0.15 * 0.15 / f64::from(substeps);
            let most = if K::REFERENCE { 0.1 * 0.15 } else { moved };
            assert!(drift.angular < most, "{drift:?}");
        }
    }
}

/// A spring moves nobody but by its force.
fn compliant_contacts_keep_angular_momentum_to_the_last_digits<K: Kind>() {
    let drift = watch::<K>(compliant(0.2, 0.1, 0.3), BLOCKS, 4, 600);
    assert!(drift.collisions > 20, "{drift:?}");
    assert!(drift.momentum < rounding::<K>(), "{drift:?}");
    // Places up to 8 sides from the origin are rounded to 8 units, times velocities of 0.1.
    let places = 8.0 * BLOCKS as f64 * 0.1 * K::ROUNDING;
    assert!(
        drift.angular < RADIUS * rounding::<K>() + 4.0 * places,
        "{drift:?}"
    );
}

/// The energy of motion of 12 cubes after 8000 ticks of collisions without damping and friction, on average over the last
/// thousand and over gases: some is in springs at any time, and none is made of nothing. What one gas gains or
/// loses by chance, in some 3000 ticks with collisions, is a tenth.
fn springs_without_damping_keep_energy<K: Kind>() {
    const GASES: u64 = 8;
    for substeps in [4, 16] {
        let late = |seed| {
            let settings = K::with_substeps(substeps);
            let springs = compliant(0.1, 0.0, 0.0);
            let drift = watch_with::<K>(springs, &gas(BLOCKS, seed), &settings, 8000);
            assert!(drift.collisions > 1000, "{drift:?}");
            drift.late
        };
        let mean = (1..=GASES).map(late).sum::<f64>() / GASES as f64;
        assert!((mean - 1.0).abs() < 0.1, "{substeps}: {mean}");
    }
}

/// Not with e near 1: Newton's law of restitution may then add energy, to a patch of which one part
/// approaches while another recedes, and together with friction (Kane and Levinson 1985).
fn inelastic_and_rough_collisions_never_add_energy<K: Kind>() {
    for (e, friction) in [(0.0, 0.0), (0.0, 0.3), (0.5, 0.0), (0.5, 0.3)] {
        for substeps in [1, 4] {
            let drift = watch::<K>(contact(e, friction), BLOCKS, substeps, 600);
            assert!(drift.collisions > 20 && drift.left < 0.7, "{drift:?}");
            // The reference pushes overlaps apart with a velocity, of which a little remains.
            let most = if K::REFERENCE {
                1e-5
            } else {
                16.0 * K::ROUNDING
            };
            assert!(drift.gain < most, "{e} {friction} {substeps}: {drift:?}");
        }
    }
}

/// None is gained but by rounding. What ten rounds cut short is lost: a part of 2e-4 of the energy of
/// a pair at worst is within the solver's tolerance, and few patches need more rounds than that.
fn elastic_collisions_keep_energy<K: Kind>() {
    for substeps in [1, 8] {
        let drift = watch::<K>(contact(1.0, 0.0), BLOCKS, substeps, 1000);
        assert!(drift.collisions > 40, "{drift:?}");
        assert!(drift.gain < 16.0 * K::ROUNDING, "{drift:?}");
        let tolerated = 2e-4 * 2.0 / BLOCKS as f64 * drift.collisions as f64;
        assert!(drift.left > 1.0 - tolerated, "{drift:?}");
    }
}

/// Balls touch at one point, so that nothing is left but rounding.
fn elastic_balls_keep_energy_to_the_last_digits<K: Kind>(ticks: u64) {
    let settings = Settings {
        reduction: Some(Reduction::Corners),
        ..K::settings()
    };
    let drift = watch_with::<K>(contact(1.0, 0.0), &gas(BLOCKS, 7), &settings, ticks);
    assert!(drift.collisions as u64 > ticks / 50, "{drift:?}");
    // Each collision rounds a dozen numbers, at random. A ball that touches two at once, in fewer than one
    // collision of fifty, is solved within 1e-4 of its speed, and of its energy within twice that.
    let collisions = drift.collisions as f64;
    let rounded = 4.0 * K::ROUNDING * (12.0 * collisions).sqrt();
    let unsolved = 2e-4 / BLOCKS as f64 * (collisions / 50.0).sqrt();
    assert!((drift.left - 1.0).abs() < rounded + unsolved, "{drift:?}");
}

fn elastic_balls_keep_energy<K: Kind>() {
    elastic_balls_keep_energy_to_the_last_digits::<K>(3000);
}

/// `cargo test --release -p stochc-runtime --test mechanics conservation -- --ignored`.
#[test]
#[ignore = "takes minutes without optimization"]
fn a_million_ticks_of_elastic_balls() {
    elastic_balls_keep_energy_to_the_last_digits::<Single>(1_000_000);
    elastic_balls_keep_energy_to_the_last_digits::<Double>(1_000_000);
}

/// The same of cubes: in a million ticks less than a hundredth is lost.
#[test]
#[ignore = "takes minutes without optimization"]
fn a_million_ticks_of_elastic_cubes() {
    let elastic = contact(1.0, 0.0);
    let drifts = [
        watch::<Single>(elastic.clone(), BLOCKS, 1, 1_000_000),
        watch::<Double>(elastic, BLOCKS, 1, 1_000_000),
    ];
    for drift in drifts {
        assert!(drift.collisions > 50_000, "{drift:?}");
        assert!(drift.gain < 1e-6 && drift.left > 0.99, "{drift:?}");
    }
}
