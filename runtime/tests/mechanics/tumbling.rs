//! Tests a cube that turns freely. Its inertia is equal about all axes, so its spin is constant.

use crate::scenes::{Dice, Kind, at, attract, empty, pass};
use nalgebra::{UnitQuaternion, Vector3};
use stochc_ir::{Cell, Face};
use stochc_runtime::world::{BlockFace, Body, BodyState, SpatialWorld, World};

in_every_kind!(
    no_axis_is_special,
    a_cube_that_is_watched_turns_as_one_that_is_not,
);

fn spinning(orientation: UnitQuaternion<f64>, spin: Vector3<f64>) -> BodyState {
    BodyState {
        orientation,
        spin,
        ..BodyState::at_rest(at(0.1, 0.0, 0.9))
    }
}

/// Returns the angle between the expected and the actual orientation of a cube.
fn astray(start: &BodyState, end: &BodyState, ticks: u64) -> f64 {
    let turn = UnitQuaternion::from_scaled_axis(start.spin * ticks as f64);
    (turn * start.orientation).angle_to(&end.orientation)
}

/// A body with three different moments of inertia flips over when it turns about its middle axis. A
/// cube must not flip about any axis.
fn no_axis_is_special<K: Kind>() {
    let ticks = 100_000;
    let mut dice = Dice::new(1);
    let axes = [
        Vector3::x(),
        Vector3::y(),
        Vector3::z(),
        at(1.0, 1.0, 0.0),
        dice.direction(),
    ];
    let blocks: Vec<BodyState> = axes
        .iter()
        .map(|axis| {
            let orientation = dice.rotation();
            let spin = orientation * (0.05 * axis.normalize() + 0.0005 * dice.direction());
            spinning(orientation, spin.map(|x| f64::from(x as f32)))
        })
        .collect();
    let mut world = K::world(&empty(), &blocks);
    pass(&mut world, ticks);
    for (id, start) in blocks.iter().enumerate() {
        let end = world.state(id as u32);
        assert_eq!(end.spin, start.spin);
        // The kernel updates an orientation when it is read. It rounds the three components of the
        // angle and of the start once.
        let roundings = if K::REFERENCE {
            in_reference(ticks)
        } else {
            4.0 + 4.0 * 0.05 * ticks as f64
        };
        let off = astray(start, &end, ticks);
        assert!(off < roundings * K::ROUNDING, "{off:e}");
    }
}

/// Returns the error of Rapier. It divides a tick into four steps and rounds four components in
/// each. In the worst case all errors have the same sign.
fn in_reference(ticks: u64) -> f64 {
    16.0 * ticks as f64
}

const SPIN: f64 = 0.02;

/// Turns a cube near a magnet, which reads its orientation in every tick.
fn watched<K: Kind>(ticks: u64) {
    let mut scene = empty();
    // The magnet has no force and never captures.
    scene.bond = attract(0.0, 0.0);
    let mut dice = Dice::new(2);
    let spin = (SPIN * dice.direction()).map(|x| f64::from(x as f32));
    let start = spinning(dice.rotation(), spin);
    let mut world = K::world(&scene, &[start]);
    let (body, face) = (Body::Seed(Cell::new(1, 1, 0)), Face::Up);
    world.magnetize(BlockFace { body, face });
    let mut dockings = Vec::new();
    for _ in 0..ticks {
        world.step(&mut dockings).expect("the physics is stable");
    }
    let end = world.state(0);
    assert_eq!(end.spin, start.spin);
    // Four components are rounded about six times per tick, by at most one unit. The limit is three
    // times the random walk of these errors. The rotation of one tick is constant, and its error of
    // up to four units always has the same sign.
    let roundings = if K::REFERENCE {
        in_reference(ticks)
    } else {
        3.0 * (24.0 * ticks as f64).sqrt() + 4.0 * SPIN * ticks as f64
    };
    let off = astray(&start, &end, ticks);
    assert!(off < roundings * K::ROUNDING, "{off:e}");
    assert_eq!(world.active()[0].1, 1, "it entered the reach exactly once");
}

fn a_cube_that_is_watched_turns_as_one_that_is_not<K: Kind>() {
    watched::<K>(20_000);
}

/// Runs a million ticks: `cargo test --release -p stochc-runtime --test mechanics tumbling --
/// --ignored`.
#[test]
#[ignore = "takes a minute without optimization"]
fn orientations_stay_normalized_for_a_million_ticks() {
    watched::<crate::scenes::Single>(1_000_000);
    watched::<crate::scenes::Double>(1_000_000);
}
