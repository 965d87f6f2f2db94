//! Compares single collisions with their closed forms.
//!
//! Bodies begin with an overlap of [`DEPTH`], which is too small to be corrected. So the first step
//! computes the collision of exactly this geometry. Consider an impulse J along n at the arms r. It
//! changes velocities by J n / m and spins by (r x n) J / I, with I = 1/6.

use crate::scenes::{Dice, Kind, at, attract, contact, empty, hemisphere, pass, states};
use nalgebra::{UnitQuaternion, Vector3};
use stochc_ir::scene::Scene;
use stochc_ir::{Cell, Face};
use stochc_runtime::world::{BlockFace, Body, BodyState, SpatialWorld, World};

in_every_kind!(
    a_corner_that_hits_the_ground_off_centre_gets_the_impulse_of_the_closed_form,
    a_corner_that_hits_a_face_pushes_both_blocks_as_the_closed_form_says,
    two_edges_that_cross_push_both_blocks_as_the_closed_form_says,
    faces_that_meet_head_on_part_e_times_as_fast,
    a_corner_that_hits_aslant_sticks_or_slides_as_coulomb_says,
    an_anchored_block_is_as_firm_as_the_ground,
);

/// Tests of the kernel only. In these cases the blocks of the reference turn up to 30 % too fast.
mod patches {
    use super::*;
    in_either_precision!(faces_that_meet_off_centre_share_the_impulse_in_the_middle_of_the_patch);
}

/// Overlap at the start, in block lengths.
const DEPTH: f64 = 1.0 / 2048.0;

const RESTITUTIONS: [f64; 4] = [0.0, 0.25, 0.5, 1.0];

/// Returns the tolerance of a component after a frictionless collision at a single point. Motions
/// are about 0.1 per tick.
///
/// Positions within 4 block lengths of the origin are rounded to 4 units of [`Kind::ROUNDING`], and
/// so are the arms. Velocities follow with a factor of 6 (1 / I), and half a dozen operations round
/// after that. The reference stores contact points in the frames of both blocks. It solves in four
/// steps and rounds four times as often.
fn rounding<K: Kind>() -> f64 {
    let steps = if K::REFERENCE { 4.0 } else { 1.0 };
    200.0 * steps * 0.1 * K::ROUNDING
}

/// Returns the tolerance if several points of a face hit at `speed`.
///
/// The kernel stops after a round that changes every point by less than 1e-4 of the approach. The
/// reference has a soft contact. It separates blocks at a few hundredths of the approach, however
/// many steps it takes. An impulse at half a block length changes the spin by 6 * 1/2 of its change
/// of the velocity.
fn solved<K: Kind>(speed: f64) -> f64 {
    let part = if K::REFERENCE { 0.1 } else { 1e-4 };
    part * speed
}

fn near(found: Vector3<f64>, expected: Vector3<f64>, tolerance: f64) {
    let error = (found - expected).amax();
    assert!(
        error < tolerance,
        "{found:?} instead of {expected:?}, off by {error:e}"
    );
}

fn with_contact(restitution: f64, friction: f64) -> Scene {
    let mut scene = empty();
    scene.contact = contact(restitution, friction);
    scene
}

fn with_ground(restitution: f64, friction: f64) -> Scene {
    let mut scene = with_contact(restitution, friction);
    scene.enclosure = hemisphere(100.0, 0.01);
    scene
}

fn after<K: Kind>(scene: &Scene, blocks: &[BodyState]) -> Vec<BodyState> {
    let mut world = K::world(scene, blocks);
    pass(&mut world, 1);
    states(&world)
}

fn corners(turned: UnitQuaternion<f64>) -> Vec<Vector3<f64>> {
    let half = |bit: usize| if bit == 0 { -0.5 } else { 0.5 };
    let mut corners: Vec<Vector3<f64>> = (0..8)
        .map(|i| turned * at(half(i & 1), half(i & 2), half(i & 4)))
        .collect();
    corners.sort_by(|a, b| a.z.total_cmp(&b.z));
    corners
}

/// Returns a rotation whose lowest corner is low enough to be the only one that touches.
fn on_a_corner(dice: &mut Dice) -> (UnitQuaternion<f64>, Vector3<f64>) {
    loop {
        let turned = dice.rotation();
        let corners = corners(turned);
        if corners[1].z - corners[0].z > 0.25 {
            return (turned, corners[0]);
        }
    }
}

/// Returns velocities and spins after a frictionless collision at one point.
fn collided(
    mut pair: [BodyState; 2],
    arms: [Vector3<f64>; 2],
    n: Vector3<f64>,
    e: f64,
) -> Option<[BodyState; 2]> {
    let speed = |b: &BodyState, arm: &Vector3<f64>| (b.velocity + b.spin.cross(arm)).dot(&n);
    let approach = speed(&pair[0], &arms[0]) - speed(&pair[1], &arms[1]);
    if approach > -0.01 {
        return None;
    }
    let yields = arms.map(|arm| 1.0 + 6.0 * arm.cross(&n).norm_squared());
    let impulse = -(1.0 + e) * approach / (yields[0] + yields[1]);
    for ((block, arm), sign) in pair.iter_mut().zip(&arms).zip([1.0, -1.0]) {
        block.velocity += sign * impulse * n;
        block.spin += 6.0 * sign * impulse * arm.cross(&n);
    }
    Some(pair)
}

fn a_corner_that_hits_the_ground_off_centre_gets_the_impulse_of_the_closed_form<K: Kind>() {
    let mut dice = Dice::new(1);
    let mut cases = 0;
    for case in 0..80 {
        let e = RESTITUTIONS[case % 4];
        let (orientation, arm) = on_a_corner(&mut dice);
        let start = BodyState {
            position: at(0.7, -0.4, -arm.z - DEPTH),
            orientation,
            velocity: 0.1 * dice.direction(),
            spin: 0.1 * dice.direction(),
        };
        let approach = (start.velocity + start.spin.cross(&arm)).z;
        if approach > -0.01 {
            continue;
        }
        cases += 1;
        let n = Vector3::z();
        let impulse = -(1.0 + e) * approach / (1.0 + 6.0 * arm.cross(&n).norm_squared());
        let end = after::<K>(&with_ground(e, 0.0), &[start]).remove(0);
        near(end.velocity, start.velocity + impulse * n, rounding::<K>());
        near(
            end.spin,
            start.spin + 6.0 * impulse * arm.cross(&n),
            rounding::<K>(),
        );
    }
    assert!(cases > 30, "{cases}");
}

fn a_corner_that_hits_a_face_pushes_both_blocks_as_the_closed_form_says<K: Kind>() {
    let mut dice = Dice::new(2);
    let mut cases = 0;
    for case in 0..80 {
        let (orientation, corner) = on_a_corner(&mut dice);
        let mut inside = || 0.8 * dice.unit() - 0.4;
        let spot = at(inside(), inside(), 0.5 - 0.5 * DEPTH);
        let upper = spot - corner - at(0.0, 0.0, 0.5 * DEPTH);
        let arms = [spot - upper, spot];
        cases += usize::from(pair_as_closed_form::<K>(
            &mut dice,
            RESTITUTIONS[case % 4],
            [
                (upper, orientation),
                (at(0.0, 0.0, 0.0), UnitQuaternion::identity()),
            ],
            arms,
        ));
    }
    assert!(cases > 30, "{cases}");
}

fn two_edges_that_cross_push_both_blocks_as_the_closed_form_says<K: Kind>() {
    let mut dice = Dice::new(3);
    let mut cases = 0;
    let (quarter, high) = (std::f64::consts::FRAC_PI_4, 0.5f64.sqrt());
    for case in 0..80 {
        // The upper edge of one block is parallel to x. The lower edge of the other block crosses
        // it.
        let lower = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), quarter);
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.6 + dice.unit());
        let upper = yaw * lower;
        let along = yaw * Vector3::x();
        let mut inside = || 0.8 * dice.unit() - 0.4;
        let spot = at(inside(), 0.0, high - 0.5 * DEPTH);
        let above = spot - inside() * along + at(0.0, 0.0, high - 0.5 * DEPTH);
        cases += usize::from(pair_as_closed_form::<K>(
            &mut dice,
            RESTITUTIONS[case % 4],
            [(above, upper), (at(0.0, 0.0, 0.0), lower)],
            [spot - above, spot],
        ));
    }
    assert!(cases > 30, "{cases}");
}

/// Compares two blocks that touch at one point with the closed form. The first block is above; the
/// pair as a whole has a random orientation and motion. Returns whether the blocks approached.
fn pair_as_closed_form<K: Kind>(
    dice: &mut Dice,
    e: f64,
    poses: [(Vector3<f64>, UnitQuaternion<f64>); 2],
    arms: [Vector3<f64>; 2],
) -> bool {
    let whole = dice.rotation();
    let away = at(0.0, 0.0, 2.5);
    let start = poses.map(|(position, orientation)| BodyState {
        position: away + whole * position,
        orientation: whole * orientation,
        velocity: 0.1 * dice.direction(),
        spin: 0.1 * dice.direction(),
    });
    let arms = arms.map(|arm| whole * arm);
    let Some(expected) = collided(start, arms, whole * Vector3::z(), e) else {
        return false;
    };
    let end = after::<K>(&with_contact(e, 0.0), &start);
    for (end, expected) in end.iter().zip(&expected) {
        near(end.velocity, expected.velocity, rounding::<K>());
        near(end.spin, expected.spin, rounding::<K>());
    }
    // The changes are equal and opposite, independently of the closed form.
    let change = |i: usize| end[i].velocity - start[i].velocity;
    near(change(0) + change(1), Vector3::zeros(), rounding::<K>());
    let turned = |i: usize| {
        (end[i].spin - start[i].spin) / 6.0 + (start[i].position - away).cross(&change(i))
    };
    near(turned(0) + turned(1), Vector3::zeros(), rounding::<K>());
    true
}

fn faces_that_meet_head_on_part_e_times_as_fast<K: Kind>() {
    for e in RESTITUTIONS {
        let block = |x: f64, speed: f64| BodyState {
            velocity: at(speed, 0.0, 0.0),
            ..BodyState::at_rest(at(x, 0.0, 2.5))
        };
        let start = [block(-0.5 + DEPTH, 0.1), block(0.5, -0.05)];
        let end = after::<K>(&with_contact(e, 0.0), &start);
        // The common velocity stays 0.025. The relative speed before the collision was 0.15.
        near(
            end[0].velocity,
            at(0.025 - 0.075 * e, 0.0, 0.0),
            solved::<K>(0.15),
        );
        near(
            end[1].velocity,
            at(0.025 + 0.075 * e, 0.0, 0.0),
            solved::<K>(0.15),
        );
        near(end[0].spin, Vector3::zeros(), 3.0 * solved::<K>(0.15));
        near(end[1].spin, Vector3::zeros(), 3.0 * solved::<K>(0.15));
    }
}

/// All points of the patch separate equally fast if the impulse acts halfway between the lines of
/// the centres. Both blocks then turn alike, and J = (1 + e) v / (2 + 2 * 6 (s / 2)^2).
fn faces_that_meet_off_centre_share_the_impulse_in_the_middle_of_the_patch<K: Kind>() {
    for e in RESTITUTIONS {
        for aside in [0.2, 0.6] {
            let block = |x: f64, y: f64, speed: f64| BodyState {
                velocity: at(speed, 0.0, 0.0),
                ..BodyState::at_rest(at(x, y, 2.5))
            };
            let start = [block(-0.5 + DEPTH, 0.0, 0.1), block(0.5, aside, -0.1)];
            let end = after::<K>(&with_contact(e, 0.0), &start);
            let impulse = (1.0 + e) * 0.2 / (2.0 + 3.0 * aside * aside);
            let spin = 6.0 * impulse * aside / 2.0;
            println!(
                "{e} {aside}: {:?} {:?} expected {impulse} {spin}",
                end[0].velocity, end[0].spin
            );
            for (end, sign) in end.iter().zip([1.0, -1.0]) {
                let velocity = at(sign * (0.1 - impulse), 0.0, 0.0);
                near(end.velocity, velocity, solved::<K>(0.2));
                near(end.spin, at(0.0, 0.0, spin), 3.0 * solved::<K>(0.2));
            }
        }
    }
}

/// A cube stands on its corner with the centre above it, so impulses at the corner do not couple
/// directions. The inverse mass of the point is 1 / m upward and 1 / m + r^2 / I sideways.
fn a_corner_that_hits_aslant_sticks_or_slides_as_coulomb_says<K: Kind>() {
    let mut dice = Dice::new(5);
    let up =
        UnitQuaternion::rotation_between(&at(1.0, 1.0, 1.0), &Vector3::z()).expect("not opposite");
    // The arm ends halfway up the overlap.
    let arm = at(0.0, 0.0, 0.5 * DEPTH - 0.75f64.sqrt());
    let yields = 1.0 + 6.0 * arm.norm_squared();
    for case in 0..96 {
        let (e, friction) = (RESTITUTIONS[case % 4], [0.05, 0.2, 0.5, 1.0][case / 4 % 4]);
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 7.0 * dice.unit());
        let sideways = std::f64::consts::TAU * dice.unit();
        let (speed, slip) = (0.02 + 0.1 * dice.unit(), 0.2 * dice.unit());
        let along = at(sideways.cos(), sideways.sin(), 0.0);
        let spin = 0.05 * dice.direction();
        let start = BodyState {
            position: at(0.3, -0.6, -arm.z - 0.5 * DEPTH),
            orientation: yaw * up,
            velocity: slip * along - spin.cross(&arm) - at(0.0, 0.0, speed),
            spin,
        };
        let normal = (1.0 + e) * speed;
        let sliding = (slip / yields).min(friction * normal);
        let impulse = at(0.0, 0.0, normal) - sliding * along;
        let end = after::<K>(&with_ground(e, friction), &[start]).remove(0);
        // In these cases the reference is off by up to 0.0092 along the ground. Its friction acts
        // in four steps, each limited by the pressure in that step.
        let tolerance = if K::REFERENCE { 0.01 } else { rounding::<K>() };
        near(end.velocity, start.velocity + impulse, tolerance);
        near(
            end.spin,
            start.spin + 6.0 * arm.cross(&impulse),
            6.0 * tolerance,
        );
    }
}

/// Another block hits a captured block from above or from the side, at half its height. It bounces
/// back with e times its speed, and the captured block does not move.
fn an_anchored_block_is_as_firm_as_the_ground<K: Kind>() {
    let (e, speed) = (0.5, 0.0625);
    let mut scene = with_contact(e, 0.0);
    scene.bond = attract(0.0, 0.1);
    for (from, direction) in [
        (at(0.0, 0.0, 2.03), at(0.0, 0.0, -1.0)),
        (at(-1.53, 0.0, 0.55), at(1.0, 0.0, 0.0)),
    ] {
        let flying = BodyState {
            velocity: speed * direction,
            ..BodyState::at_rest(from)
        };
        let held = BodyState::at_rest(at(0.0, 0.0, 0.53));
        let mut world = K::world(&scene, &[held, flying]);
        let (body, face) = (Body::Seed(Cell::new(1, 1, 0)), Face::Up);
        world.magnetize(BlockFace { body, face });
        let mut dockings = Vec::new();
        for _ in 0..20 {
            world.step(&mut dockings).expect("the physics is stable");
        }
        assert_eq!(dockings.len(), 1);
        near(world.state(0).position, at(0.0, 0.0, 0.5), 1e-12);
        let back = world.state(1).velocity;
        near(back, -e * speed * direction, solved::<K>(speed));
    }
}
