//! Compares the compliant contact with a damped oscillator.
//!
//! With w = sqrt(k / m) and c = 2 m w sin(a), a block that lands flat at speed v sinks to (v / w)
//! exp(-tan(a) (pi / 2 - a)). The contact never pulls, so it ends when k d + c d' = 0, before the
//! block has left the ground. It lasts (pi - 2 a) / (w cos(a)) and returns exp(-tan(a) (pi - 2 a))
//! of the speed (Schwager and Poeschel 2007). If the contact could pull, it would last pi / (w
//! cos(a)) and return exp(-tan(a) pi).

use crate::scenes::{Kind, at, compliant, empty, hemisphere, pass};
use nalgebra::{UnitQuaternion, Vector3};
use stochc_ir::scene::Scene;
use stochc_runtime::world::{BodyState, SpatialWorld};

in_either_precision!(
    a_bounce_converges_to_the_damped_oscillator_in_the_second_order,
    substeps_are_short_ticks,
    flat_edge_and_corner_are_as_stiff_as_the_deepest_point,
    a_pair_is_as_stiff_as_one_block_on_the_ground,
    a_contact_that_ends_does_not_pull,
    a_damper_is_the_same_for_every_patch,
    a_contact_that_a_step_does_not_resolve_gains_nothing,
);

fn ground(stiffness: f64, damping: f64) -> Scene {
    let mut scene = empty();
    scene.contact = compliant(stiffness, damping, 0.0);
    scene.enclosure = hemisphere(100.0, 0.01);
    scene
}

fn falling(turned: UnitQuaternion<f64>, reach: f64, depth: f64, speed: f64) -> BodyState {
    BodyState {
        orientation: turned,
        velocity: at(0.0, 0.0, -speed),
        ..BodyState::at_rest(at(0.0, 0.0, reach - depth))
    }
}

/// Outcome of a landing: ticks with a force, ratio of the speeds after and before, greatest depth.
#[derive(Clone, Copy, Debug)]
struct Bounce {
    time: f64,
    back: f64,
    depth: f64,
}

/// Returns the mean outcome of flat landings for a contact of `frequency` per tick. The landings
/// begin at evenly spaced moments of a tick. In a single landing the damper may act half a tick too
/// long or too short.
fn bounce<K: Kind>(frequency: f64, damped: f64) -> Bounce {
    const STARTS: u32 = 32;
    let mut sum = [0.0; 3];
    for start in 0..STARTS {
        let late = (f64::from(start) + 0.5) / f64::from(STARTS);
        let one = bounce_from::<K>(frequency, damped, late);
        for (sum, part) in sum.iter_mut().zip([one.time, one.back, one.depth]) {
            *sum += part / f64::from(STARTS);
        }
    }
    let [time, back, depth] = sum;
    Bounce { time, back, depth }
}

/// Returns the outcome of a landing that reaches the ground `late` ticks after the first tick
/// began.
fn bounce_from<K: Kind>(frequency: f64, damped: f64, late: f64) -> Bounce {
    let speed = 0.1 * frequency;
    let scene = ground(frequency * frequency, 2.0 * frequency * damped);
    let start = falling(UnitQuaternion::identity(), 0.5, -late * speed, speed);
    let mut world = K::world(&scene, &[start]);
    let (mut time, mut depth, mut before) = (0u32, 0.0f64, -speed);
    loop {
        pass(&mut world, 1);
        let state = world.state(0);
        depth = depth.max(0.5 - state.position.z);
        if (state.velocity.z - before).abs() > 1e-5 * speed {
            time += 1;
        } else if state.velocity.z > 0.0 {
            break Bounce {
                time: f64::from(time) * frequency,
                back: before / speed,
                depth: depth * frequency / speed,
            };
        }
        before = state.velocity.z;
    }
}

fn a_bounce_converges_to_the_damped_oscillator_in_the_second_order<K: Kind>() {
    for damped in [0.0, 0.1, 0.3, 0.6] {
        let a = f64::asin(damped);
        let pi = std::f64::consts::PI;
        let exact = Bounce {
            time: (pi - 2.0 * a) / a.cos(),
            back: (-a.tan() * (pi - 2.0 * a)).exp(),
            depth: (-a.tan() * (pi / 2.0 - a)).exp(),
        };
        for h in [0.4, 0.2, 0.1] {
            let found = bounce::<K>(h, damped);
            // The contact ends somewhere within a tick.
            assert!((found.time - exact.time).abs() < h, "{found:?} {exact:?}");
            // An implicit step of first order would be off by pi h / 2 of the speed.
            let off = (found.back - exact.back).abs();
            assert!(
                off < 0.1 * h * h + 64.0 * K::ROUNDING,
                "{damped} {h}: {found:?} {exact:?}"
            );
            // The depth is sampled at the ends of ticks only.
            let off = (found.depth - exact.depth).abs();
            assert!(
                off < 0.2 * h * h + 64.0 * K::ROUNDING,
                "{damped} {h}: {found:?} {exact:?}"
            );
        }
    }
}

/// The results are equal to the bit if the number of substeps is a power of two.
fn substeps_are_short_ticks<K: Kind>() {
    let (stiffness, damping) = (0.04, 0.02);
    let at_once = [1u32, 2, 8].map(|substeps| {
        let n = f64::from(substeps);
        let scene = ground(stiffness * n * n, damping * n);
        let start = falling(UnitQuaternion::identity(), 0.5, 0.0, 0.01 * n);
        let mut world: K::World =
            crate::scenes::world(&scene, &K::with_substeps(substeps), &[start]);
        pass(&mut world, 32 / u64::from(substeps));
        let end = world.state(0);
        (end.position, end.velocity / n)
    });
    assert!(at_once[0].1.z > 0.0, "it is on its way up: {at_once:?}");
    assert_eq!(at_once[0], at_once[1]);
    assert_eq!(at_once[0], at_once[2]);
}

/// Returns the tolerance of one step. The kernel stops when a round changes less than 1e-4 of the
/// fastest approach. The points of a soft patch hardly affect each other, so one round is almost
/// exact.
fn one_step<K: Kind>(speed: f64) -> f64 {
    1e-4 * speed + 16.0 * K::ROUNDING * speed
}

fn flat_edge_and_corner_are_as_stiff_as_the_deepest_point<K: Kind>() {
    let (stiffness, damping) = (0.04, 0.02);
    let quarter = std::f64::consts::FRAC_PI_4;
    let flat = UnitQuaternion::identity();
    let edge = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), quarter);
    let corner = UnitQuaternion::rotation_between(&at(1.0, 1.0, 1.0), &Vector3::z())
        .expect("they are not opposite");
    for (turned, points) in [(flat, 1.0f64), (edge, 2.0), (corner, 3.0)] {
        let reach = 0.5 * points.sqrt();
        for (depth, speed) in [(0.01, 0.003), (0.02, 0.0), (0.05, -0.002)] {
            let start = falling(turned, reach, depth, speed);
            let mut world = K::world(&ground(stiffness, damping), &[start]);
            pass(&mut world, 1);
            let state = world.state(0);
            // One centred step, positive upward: v' = v + k (d - (v' - v) / 12) - c (v + v') / 2.
            let change = stiffness * depth + damping * speed;
            let expected = change / (1.0 + stiffness / 12.0 + damping / 2.0) - speed;
            // The depth is a difference of coordinates near 1.
            let tolerance = one_step::<K>(0.003) + 4.0 * stiffness * K::ROUNDING;
            let off = (state.velocity.z - expected).abs();
            assert!(off < tolerance, "{points} {depth}: off by {off:e}");
            assert!(state.spin.norm() < 6.0 * tolerance);
        }
    }
}

/// The forces equal the forces on one block, but both masses move.
fn a_pair_is_as_stiff_as_one_block_on_the_ground<K: Kind>() {
    let (stiffness, damping, depth, speed) = (0.04, 0.02, 0.01, 0.003);
    let mut scene = empty();
    scene.contact = compliant(stiffness, damping, 0.0);
    let block = |side: f64| BodyState {
        velocity: at(-side * speed, 0.0, 0.0),
        ..BodyState::at_rest(at(side * 0.5 * (1.0 - depth), 0.0, 3.0))
    };
    let mut world = K::world(&scene, &[block(1.0), block(-1.0)]);
    pass(&mut world, 1);
    // For the relative velocity u: u' = u + 2 (k (d - (u' - u) / 12) - c (u + u') / 2).
    let change = 2.0 * (stiffness * depth + 2.0 * damping * speed);
    let parting = change / (1.0 + stiffness / 6.0 + damping) - 2.0 * speed;
    let tolerance = one_step::<K>(0.006) + 8.0 * stiffness * K::ROUNDING;
    for (id, side) in [(0, 1.0), (1, -1.0)] {
        let off = (world.state(id).velocity - at(side * 0.5 * parting, 0.0, 0.0)).amax();
        assert!(off < tolerance, "{off:e}");
    }
}

fn a_contact_that_ends_does_not_pull<K: Kind>() {
    // A block that leaves faster than k d / c feels no force.
    let scene = ground(0.01, 0.5);
    let mut world = K::world(
        &scene,
        &[falling(UnitQuaternion::identity(), 0.5, 0.25, -0.03125)],
    );
    pass(&mut world, 1);
    assert_eq!(world.state(0).velocity, at(0.0, 0.0, 0.03125));
    // During a whole bounce the block is never slowed on its way out, whatever the damping.
    for damped in [0.1, 0.5, 0.9, 1.5] {
        let scene = ground(0.01, 0.2 * damped);
        let mut world = K::world(
            &scene,
            &[falling(UnitQuaternion::identity(), 0.5, 0.0, 0.05)],
        );
        let mut before = world.state(0).velocity.z;
        for _ in 0..200 {
            pass(&mut world, 1);
            let speed = world.state(0).velocity.z;
            assert!(speed >= before, "{damped}: {before} and then {speed}");
            before = speed;
        }
        assert!(before > 0.0);
    }
}

/// A patch is damped as a whole, whatever the number of its points and their depths.
fn a_damper_is_the_same_for_every_patch<K: Kind>() {
    let (damping, speed, deepest) = (0.02, 0.003, 0.03);
    for tilt in [0.0, 0.2, 1.0, 3.0f64] {
        let tilt = tilt.to_radians();
        let turned = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), tilt);
        let reach = 0.5 * (tilt.cos() + tilt.sin());
        let mut world = K::world(
            &ground(1e-20, damping),
            &[falling(turned, reach, deepest, speed)],
        );
        pass(&mut world, 1);
        let slowed = (world.state(0).velocity.z + speed) / speed;
        // On an edge the block also turns, so its inverse mass is 1 + 6 / 4 instead of 1.
        let [level, edge] = [1.0, 2.5].map(|yields| damping / (1.0 + 0.5 * yields * damping));
        let rounding = 1e-3 * damping;
        assert!(
            (edge - rounding..level + rounding).contains(&slowed),
            "{tilt}: {slowed}"
        );
    }
}

/// This holds for every stiffness and damping, and for every start of the contact within a step.
fn a_contact_that_a_step_does_not_resolve_gains_nothing<K: Kind>() {
    for (stiffness, damping) in [(8.0, 0.0), (1e3, 0.0), (1e9, 0.0), (0.1, 1e9), (1e9, 1e9)] {
        let scene = ground(stiffness, damping);
        for start in 0..16 {
            let (late, speed) = (f64::from(start) / 16.0, 0.25);
            let begin = falling(UnitQuaternion::identity(), 0.5, -late * speed, speed);
            let mut world = K::world(&scene, &[begin]);
            pass(&mut world, 50);
            let back = world.state(0).velocity.z;
            assert!(
                back <= speed * (1.0 + 1e-5),
                "{stiffness} {damping} {late}: {back}"
            );
        }
    }
}
