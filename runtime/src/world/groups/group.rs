//! A group of bonded free blocks.
use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use stochc_ir::Face;

use super::rigid_motion::RigidMotion;
use crate::world::blocks::{Blocks, Motion};
use crate::world::bonding::AttractingFace;

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct BlockGroup {
    /// Members in ascending order.
    pub(super) members: Vec<GroupMember>,
    pub(super) bonds: Vec<(u32, u32)>,
    pub(super) rotation: UnitQuaternion<f64>,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct GroupMember {
    pub(super) id: u32,
    /// Position from the group's centre, in the group's frame.
    pub(super) offset: Vector3<f64>,
    /// Rotation relative to the group's frame.
    pub(super) turn: UnitQuaternion<f64>,
}

impl BlockGroup {
    pub(super) fn member(&self, id: u32) -> Option<&GroupMember> {
        let at = (self.members).binary_search_by_key(&id, |member| member.id);
        at.ok().map(|at| &self.members[at])
    }

    /// Returns the face of a member that meets another one.
    pub(super) fn face(&self, id: u32, other: u32) -> Option<Face> {
        let (from, to) = (self.member(id)?, self.member(other)?);
        Some(AttractingFace::<f64>::facing(
            from.offset,
            from.turn,
            to.offset,
        ))
    }

    /// Returns the motions of the members in order.
    pub(super) fn motions(&self, blocks: &impl Blocks) -> Vec<Motion> {
        let motion = |member: &GroupMember| blocks.motion(member.id);
        self.members.iter().map(motion).collect()
    }

    /// Gives each member the velocity and spin that `body` has at the member's position. `there`
    /// contains the present motions of the members, in the same order.
    pub(super) fn stiffen(&self, body: &RigidMotion, there: &[Motion], blocks: &mut impl Blocks) {
        for (member, motion) in self.members.iter().zip(there) {
            let (velocity, spin) = body.at(motion.position);
            blocks.set_motion(member.id, velocity, spin);
        }
    }
}

/// Returns a block and all blocks connected to it by these bonds, the nearest first.
pub(super) fn connected(first: u32, bonds: &[(u32, u32)]) -> Vec<u32> {
    let mut found = vec![first];
    let mut next = 0;
    while let Some(&at) = found.get(next) {
        next += 1;
        for &(a, b) in bonds {
            let other = if a == at { b } else { a };
            if (a == at || b == at) && !found.contains(&other) {
                found.push(other);
            }
        }
    }
    found
}
