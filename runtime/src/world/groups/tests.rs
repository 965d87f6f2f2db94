use std::collections::BTreeSet;

use nalgebra::{UnitQuaternion, Vector3};

use super::super::blocks::{Blocks, Motion, Pose};
use super::super::external_forces::Response;
use super::*;
use crate::world::BodyState;
use crate::world::rigid::Bodies;

const INERTIA: f64 = 1.0 / 6.0;

/// Returns blocks at rest at these positions.
fn at(positions: &[[f64; 3]]) -> Bodies<f64> {
    let states = positions
        .iter()
        .map(|&position| BodyState::at_rest(position.into()));
    Bodies::new(&states.collect::<Vec<_>>(), 1.0, 1.0)
}

fn motions(blocks: &Bodies<f64>) -> impl Iterator<Item = Motion> {
    (0..blocks.count()).map(|id| blocks.motion(id))
}

fn momenta(blocks: &Bodies<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let turning = |m: Motion| m.position.cross(&m.velocity) + m.spin * INERTIA;
    let momentum = motions(blocks).map(|motion| motion.velocity).sum();
    (momentum, motions(blocks).map(turning).sum())
}

fn fly(blocks: &mut Bodies<f64>, dt: f64) {
    for id in 0..blocks.count() {
        blocks.set_position(id, blocks.position(id) + blocks.velocity(id) * dt);
    }
}

/// Returns blocks in a row along x, each bonded to the next.
fn row(count: u32) -> (BlockGroups, Bodies<f64>) {
    let positions: Vec<[f64; 3]> = (0..count).map(|i| [f64::from(i), 0.0, 0.0]).collect();
    let (mut groups, mut blocks) = (BlockGroups::default(), at(&positions));
    for b in 1..count {
        let seat = blocks.pose(b);
        groups.join(b - 1, b, &seat, &mut blocks, Response::FREE);
    }
    (groups, blocks)
}

#[test]
fn a_group_conserves_its_momenta() {
    let (mut groups, mut blocks) = row(3);
    assert_eq!(groups.list(), [[0, 1, 2]]);
    blocks.set_velocity(2, Vector3::new(0.1, 0.3, -0.2), Vector3::new(0.1, 0.0, 0.4));
    let before = momenta(&blocks);
    assert_eq!(groups.settle(&mut blocks, 1e9, Response::FREE, 1.0), 0);
    for _ in 0..1000 {
        fly(&mut blocks, 0.1);
        groups.carry(&mut blocks, Response::FREE, 0.1);
        for (a, b) in [(0, 1), (1, 2)] {
            let displacement = blocks.position(b) - blocks.position(a);
            assert!((displacement.norm() - 1.0).abs() < 1e-9);
        }
    }
    let after = momenta(&blocks);
    assert!((before.0 - after.0).norm() < 1e-12);
    assert!((before.1 - after.1).norm() < 1e-9, "{before:?} {after:?}");
}

#[test]
fn bonded_blocks_move_together_at_once() {
    let (mut groups, mut blocks) = (BlockGroups::default(), at(&[[0.0; 3], [1.0, 0.0, 0.0]]));
    blocks.set_velocity(1, Vector3::new(-0.4, 0.2, 0.0), Vector3::z() * 0.1);
    let before = momenta(&blocks);
    let seat = blocks.pose(1);
    groups.join(0, 1, &seat, &mut blocks, Response::FREE);
    let after = momenta(&blocks);
    assert!((before.0 - after.0).norm() + (before.1 - after.1).norm() < 1e-12);
    // The bond carries only the centripetal force.
    let turning = blocks.motion(0).spin.norm_squared() / 2.0;
    assert_eq!(
        groups.settle(&mut blocks, 1.001 * turning, Response::FREE, 1e-3),
        0
    );
}

#[test]
fn a_bond_carries_the_load_behind_it() {
    // If a force acts on the first of n equal blocks, the last bond carries 1/n of the force.
    for count in 2..6_u32 {
        let (force, dt) = (0.6, 0.25);
        let tear = |hold: f64| {
            let (mut groups, mut blocks) = row(count);
            blocks.set_velocity(0, Vector3::x() * (-force * dt), Vector3::zeros());
            groups.settle(&mut blocks, hold, Response::FREE, dt)
        };
        // The first bond pulls all other blocks.
        let load = force * f64::from(count - 1) / f64::from(count);
        assert_eq!(tear(load * 1.001), 0, "{count}");
        assert!(tear(load * 0.999) > 0, "{count}");
    }
}

#[test]
fn a_moment_tips_a_face_about_its_edge() {
    let (torque, dt) = (0.12, 0.5);
    let tear = |hold: f64| {
        let (mut groups, mut blocks) = row(2);
        blocks.set_velocity(0, Vector3::zeros(), Vector3::z() * (torque * dt / INERTIA));
        let (mut other, opposite) = (blocks.motion(1), Vector3::z() * (-torque * dt / INERTIA));
        other.spin = opposite;
        blocks.set_velocity(1, other.velocity, other.spin);
        groups.settle(&mut blocks, hold, Response::FREE, dt)
    };
    // Opposite torques leave the pair at rest. The bond carries one of them with a lever arm of
    // half a block length.
    assert_eq!(tear(2.0 * torque * 1.001), 0);
    assert_eq!(tear(2.0 * torque * 0.999), 1);
}

#[test]
fn a_spinning_row_is_torn_by_its_inertia() {
    // In a row of five, a bond next to the centre keeps two blocks on their circles. Its load is (1
    // + 2) times the spin squared.
    for (spin, tears) in [(0.10, false), (0.12, true)] {
        let (mut groups, mut blocks) = row(5);
        for id in 0..5 {
            let arm = Vector3::x() * (f64::from(id) - 2.0);
            let turning = Vector3::z() * spin;
            blocks.set_velocity(id, turning.cross(&arm), turning);
        }
        let torn = groups.settle(&mut blocks, 3.0 * 0.11 * 0.11, Response::FREE, 0.25);
        assert_eq!(torn > 0, tears, "{spin}");
    }
}

#[test]
fn a_squeezed_bond_holds() {
    let (mut groups, mut blocks) = row(2);
    blocks.set_velocity(0, Vector3::x(), Vector3::zeros());
    blocks.set_velocity(1, -Vector3::x(), Vector3::zeros());
    assert_eq!(groups.settle(&mut blocks, 1e-9, Response::FREE, 1.0), 0);
    assert!(momenta(&blocks).0.norm() < 1e-12);
}

#[test]
fn torn_blocks_do_not_bond_while_separating() {
    let (mut groups, mut blocks) = row(4);
    blocks.set_velocity(3, Vector3::x() * 0.5, Vector3::zeros());
    assert_eq!(groups.settle(&mut blocks, 0.2, Response::FREE, 1.0), 1);
    assert_eq!(groups.list(), [[0, 1, 2]]);
    assert_eq!((groups.with(0), groups.with(3)), (vec![0, 1, 2], vec![3]));
    assert!((blocks.motion(3).velocity.x - 0.5).abs() < 1e-12);
    assert!(groups.are_parted(3, 2));
    groups.forgive(&BTreeSet::from([(2, 3)]));
    assert!(groups.are_parted(2, 3));
    groups.forgive(&BTreeSet::new());
    assert!(!groups.are_parted(2, 3));
}

#[test]
fn a_block_that_leaves_the_middle_splits_the_group() {
    let (mut groups, mut blocks) = row(5);
    assert_eq!(groups.remove(2, &mut blocks), [1, 3]);
    assert_eq!(groups.list(), [vec![0, 1], vec![3, 4]]);
    assert!(groups.remove(2, &mut blocks).is_empty());
    assert_eq!(groups.remove(0, &mut blocks), [1]);
    assert_eq!(groups.list(), [[3, 4]]);
    assert!(!groups.same(0, 1) && groups.same(3, 4));
}

#[test]
fn a_group_joins_another_unchanged() {
    let positions = [
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [2.02, 0.0, 0.0],
        [2.02, 1.0, 0.0],
    ];
    let (mut groups, mut blocks) = (BlockGroups::default(), at(&positions));
    let seat = blocks.pose(1);
    groups.join(0, 1, &seat, &mut blocks, Response::FREE);
    let seat = blocks.pose(3);
    groups.join(2, 3, &seat, &mut blocks, Response::FREE);
    // Block 2 moves to its place on block 1, a quarter turn about x further.
    let seat = Pose {
        position: Vector3::new(2.0, 0.0, 0.0),
        rotation: UnitQuaternion::from_scaled_axis(Vector3::x() * std::f64::consts::FRAC_PI_2),
    };
    groups.join(1, 2, &seat, &mut blocks, Response::FREE);
    assert_eq!(groups.list(), [[0, 1, 2, 3]]);
    // Relative to the first block.
    let first = blocks.pose(0);
    for (id, expected) in [
        (1, [1.0, 0.0, 0.0]),
        (2, [2.0, 0.0, 0.0]),
        (3, [2.0, 0.0, 1.0]),
    ] {
        let displacement = first.rotation.inverse() * (blocks.pose(id).position - first.position);
        assert!(
            (displacement - Vector3::from(expected)).norm() < 1e-12,
            "{id} {displacement}"
        );
    }
}

#[test]
fn bonding_conserves_centre_and_momenta() {
    let positions = [[0.0; 3], [1.03, -0.02, 0.01], [1.03, 0.98, 0.01]];
    let (mut groups, mut blocks) = (BlockGroups::default(), at(&positions));
    let seat = blocks.pose(2);
    groups.join(1, 2, &seat, &mut blocks, Response::FREE);
    blocks.set_velocity(0, Vector3::new(0.1, 0.2, -0.3), Vector3::new(0.3, 0.1, 0.2));
    let middle = |blocks: &Bodies<f64>| motions(blocks).map(|m| m.position).sum::<Vector3<f64>>();
    let before = (momenta(&blocks), middle(&blocks));
    let seat = Pose {
        position: Vector3::x(),
        rotation: UnitQuaternion::from_scaled_axis(Vector3::new(0.05, -0.02, 0.1)),
    };
    groups.join(0, 1, &seat, &mut blocks, Response::FREE);
    let after = (momenta(&blocks), middle(&blocks));
    assert!((before.1 - after.1).norm() < 1e-12);
    assert!((before.0.0 - after.0.0).norm() + (before.0.1 - after.0.1).norm() < 1e-12);
}
