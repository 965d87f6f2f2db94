//! Tests Coulomb friction of a cube that is pressed on the ground.
//!
//! The scene has no gravity. The test adds a change of velocity before every tick, which the
//! contact has to cancel within the tick.

use crate::scenes::{Dice, Double, Kind, Reference, Single, at, contact, empty, hemisphere, pass};
use nalgebra::{UnitQuaternion, Vector3};
use stochc_runtime::world::{BodyState, SpatialWorld};

in_every_kind!(
    a_pressed_cube_holds_below_the_cone_and_slides_above_it,
    a_sliding_cube_comes_to_rest_where_it_should,
);

#[test]
fn the_cone_of_the_reference_is_the_same_in_all_directions() {
    the_cone_is_the_same_in_all_directions::<Reference>();
}

#[test]
fn the_cone_of_the_kernel_is_the_same_in_all_directions() {
    the_cone_is_the_same_in_all_directions::<Single>();
    the_cone_is_the_same_in_all_directions::<Double>();
}

/// The reference is not tested, because its friction deviates too much.
#[test]
fn friction_of_the_kernel_opposes_sliding() {
    friction_at_a_corner_opposes_the_sliding::<Single>();
    friction_at_a_corner_opposes_the_sliding::<Double>();
}

/// Pressure per tick. Unit: block lengths per square tick.
const WEIGHT: f64 = 0.01;
const FRICTION: f64 = 0.3;

/// Fastest sliding. Unit: block lengths per tick.
const SPEED: f64 = 0.15;

/// Returns the tolerance of the friction, as a fraction of the weight.
///
/// The kernel stops its rounds when no point changes by more than 1e-4 of the fastest motion. Here
/// the fastest motion is the sliding. Each further round would remove at least a quarter of the
/// error. So the remaining error is at most three times the last change. The reference has a soft
/// contact, and the cube rocks on it. Its weight presses on the ground only on average, to one tick
/// in a hundred.
fn slack<K: Kind>() -> f64 {
    if K::REFERENCE {
        0.01
    } else {
        3.0 * 1e-4 * SPEED / WEIGHT
    }
}

/// Returns a cube flat on the ground, yawed, in contact and without an overlap that is corrected.
fn flat(yaw: f64, velocity: Vector3<f64>) -> BodyState {
    BodyState {
        orientation: UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw),
        velocity,
        ..BodyState::at_rest(at(0.0, 0.0, 0.5 - 1.0 / 2048.0))
    }
}

fn on_ground<K: Kind>(block: BodyState) -> K::World {
    let mut scene = empty();
    scene.contact = contact(0.0, FRICTION);
    scene.enclosure = hemisphere(200.0, 0.01);
    K::world(&scene, &[block])
}

/// Runs ticks with the weight and a pull along the ground. Returns the final state of the cube.
fn press<K: Kind>(world: &mut K::World, pull: Vector3<f64>, ticks: u64) -> BodyState {
    for _ in 0..ticks {
        let mut state = world.state(0);
        state.velocity += pull - at(0.0, 0.0, WEIGHT);
        world.set_state(0, &state);
        pass(world, 1);
    }
    world.state(0)
}

fn along(angle: f64) -> Vector3<f64> {
    at(angle.cos(), angle.sin(), 0.0)
}

fn a_pressed_cube_holds_below_the_cone_and_slides_above_it<K: Kind>() {
    let ticks = 100;
    for (pull, acceleration) in [(0.9, 0.0), (1.1, 0.1), (2.0, 1.0)] {
        let mut world = on_ground::<K>(flat(0.3, Vector3::zeros()));
        let pull = pull * FRICTION * WEIGHT * along(1.0);
        let end = press::<K>(&mut world, pull, ticks);
        let expected = acceleration * FRICTION * WEIGHT * ticks as f64 * along(1.0);
        let off = (end.velocity - expected).norm() / (WEIGHT * ticks as f64);
        assert!(off < slack::<K>(), "{off:e}");
    }
}

fn the_cone_is_the_same_in_all_directions<K: Kind>() {
    let ticks = 40;
    for yaw in [0.0, 0.4] {
        for direction in 0..16 {
            let heading = along(f64::from(direction) * std::f64::consts::TAU / 16.0);
            let mut world = on_ground::<K>(flat(yaw, SPEED * heading));
            let end = press::<K>(&mut world, Vector3::zeros(), ticks);
            let slowed = (SPEED * heading - end.velocity) / (WEIGHT * ticks as f64);
            let off = (slowed - FRICTION * heading).norm();
            assert!(off < slack::<K>(), "{yaw} {direction}: {slowed:?}");
        }
    }
}

fn a_sliding_cube_comes_to_rest_where_it_should<K: Kind>() {
    let speed = SPEED;
    let mut world = on_ground::<K>(flat(0.2, speed * along(2.0)));
    let start = world.state(0).position;
    let stops = speed / (FRICTION * WEIGHT);
    let end = press::<K>(&mut world, Vector3::zeros(), stops as u64 + 20);
    // The reference still rocks on its soft contact, by a tenth of the weight in a tick.
    let rocking = if K::REFERENCE { 0.15 } else { slack::<K>() };
    assert!(end.velocity.norm() < rocking * WEIGHT);
    // Symplectic Euler: the sum of v0 - k mu g. It is v0^2 / (2 mu g) less half a tick at full
    // speed.
    let distance = (end.position - start).norm();
    let expected = speed * speed / (2.0 * FRICTION * WEIGHT) - 0.5 * speed;
    assert!(
        (distance - expected).abs() < slack::<K>() / FRICTION * expected + 0.5 * FRICTION * WEIGHT
    );
    let rest = press::<K>(&mut world, Vector3::zeros(), 50);
    assert!((rest.position - end.position).norm() < 50.0 * rocking * WEIGHT);
}

/// One corner slides all the time. The friction is opposite to the remaining sliding and as large
/// as the cone allows, wherever the centre is.
fn friction_at_a_corner_opposes_the_sliding<K: Kind>() {
    let mut dice = Dice::new(1);
    let mut scene = empty();
    scene.contact = contact(0.0, FRICTION);
    scene.enclosure = hemisphere(200.0, 0.01);
    let mut cases = 0;
    while cases < 40 {
        let orientation = dice.rotation();
        let Some(arm) = only_corner(orientation) else {
            continue;
        };
        cases += 1;
        // The block slides at 0.2 and presses at 0.005.
        let angle = std::f64::consts::TAU * dice.unit();
        let start = BodyState {
            orientation,
            velocity: 0.2 * along(angle) - at(0.0, 0.0, 0.005),
            ..BodyState::at_rest(at(0.0, 0.0, -arm.z - 1.0 / 2048.0))
        };
        let mut world = K::world(&scene, &[start]);
        pass(&mut world, 1);
        let end = world.state(0);
        let impulse = end.velocity - start.velocity;
        let sliding = (end.velocity + end.spin.cross(&(arm + at(0.0, 0.0, 1.0 / 4096.0)))).xy();
        let (push, pressing) = (impulse.xy(), impulse.z);
        assert!(pressing > 1e-4 && sliding.norm() > 0.1);
        // The last change of a round is below 1e-4 of the sliding. Further changes sum to at most
        // three times that. Relative to the push, the error is larger by sliding / pressing.
        let slack = 3.0 * 1e-4 * 0.2 / pressing;
        let size = push.norm() / (FRICTION * pressing);
        assert!((size - 1.0).abs() < slack, "{size}");
        let cosine = -push.dot(&sliding) / (push.norm() * sliding.norm());
        let astray = cosine.min(1.0).acos();
        assert!(
            astray < slack,
            "friction is {:.1} degrees off",
            astray.to_degrees()
        );
    }
}

/// Returns the vector from the centre to the lowest corner. Returns `None` if another corner is
/// nearly as low.
fn only_corner(turned: UnitQuaternion<f64>) -> Option<Vector3<f64>> {
    let half = |bit: usize| if bit == 0 { -0.5 } else { 0.5 };
    let mut corners: Vec<Vector3<f64>> = (0..8)
        .map(|i| turned * at(half(i & 1), half(i & 2), half(i & 4)))
        .collect();
    corners.sort_by(|a, b| a.z.total_cmp(&b.z));
    (corners[1].z - corners[0].z > 0.25).then_some(corners[0])
}
