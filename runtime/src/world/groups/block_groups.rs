//! All groups of bonded free blocks.
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::UnitQuaternion;
use serde::{Deserialize, Serialize};
use stochc_ir::Face;

use super::group::{BlockGroup, GroupMember, connected};
use super::rigid_motion::RigidMotion;
use super::{bond_load, rigid_motion};
use crate::world::FreeBond;
use crate::world::blocks::{Blocks, Motion, Pose};
use crate::world::external_forces::Response;

#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct BlockGroups {
    /// Key of the group of each block.
    pub(super) of: BTreeMap<u32, u32>,
    /// Groups by key. The key is the number of a present or former member.
    pub(super) groups: BTreeMap<u32, BlockGroup>,
    /// Broken pairs that are still separating.
    parted: BTreeSet<(u32, u32)>,
}

impl BlockGroups {
    /// Returns the members of every group, sorted.
    pub fn list(&self) -> Vec<Vec<u32>> {
        let ids = |group: &BlockGroup| group.members.iter().map(|member| member.id).collect();
        let mut all: Vec<Vec<u32>> = self.groups.values().map(ids).collect();
        all.sort_unstable();
        all
    }

    #[cfg(feature = "rapier")]
    pub fn bonds(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.groups
            .values()
            .flat_map(|group| group.bonds.iter().copied())
    }

    /// Returns the bonds with both faces, in ascending order.
    pub fn bonded_faces(&self) -> Vec<FreeBond> {
        let bonded = |group: &BlockGroup, (a, b): (u32, u32)| {
            let (first, second) = (a.min(b), a.max(b));
            Some(FreeBond {
                bodies: [first, second],
                faces: [group.face(first, second)?, group.face(second, first)?],
            })
        };
        let mut all: Vec<FreeBond> = (self.groups.values())
            .flat_map(|group| group.bonds.iter().filter_map(|&bond| bonded(group, bond)))
            .collect();
        all.sort_unstable();
        all
    }

    /// Returns whether two blocks are in one group.
    pub fn same(&self, a: u32, b: u32) -> bool {
        self.of
            .get(&a)
            .is_some_and(|key| self.of.get(&b) == Some(key))
    }

    /// Returns all members of a block's group, including itself.
    pub fn with(&self, id: u32) -> Vec<u32> {
        let group = self.of.get(&id).and_then(|key| self.groups.get(key));
        group.map_or_else(
            || vec![id],
            |group| group.members.iter().map(|member| member.id).collect(),
        )
    }

    /// Returns whether two blocks are a broken pair that is still separating.
    pub fn are_parted(&self, a: u32, b: u32) -> bool {
        self.parted.contains(&(a.min(b), a.max(b)))
    }

    /// Forgets broken pairs except those in `parting`. Forgotten pairs can bond again.
    pub fn forgive(&mut self, parting: &BTreeSet<(u32, u32)>) {
        self.parted.retain(|pair| parting.contains(pair));
    }

    /// Returns whether `b` and its group fit when `b` moves to `seat` on `a`. They do not fit if a
    /// face would get a second bond.
    pub fn have_room(&self, a: u32, b: u32, seat: &Pose, blocks: &mut impl Blocks) -> bool {
        let was = blocks.pose(b);
        let there: Vec<_> = (self.with(a).into_iter())
            .map(|id| blocks.exact_position(id))
            .collect();
        self.with(b).into_iter().all(|id| {
            let comes_to = blocks.pose(id).carried(&was, seat).position;
            // Adjacent blocks are one block length apart, overlapping ones less.
            there.iter().all(|at| (at - comes_to).norm() > 0.5)
        })
    }

    pub fn is_bonded(&self, id: u32, face: Face) -> bool {
        let group = self.of.get(&id).and_then(|key| self.groups.get(key));
        group.is_some_and(|group| {
            (group.bonds.iter()).any(|&(a, b)| match id {
                _ if a == id => group.face(a, b) == Some(face),
                _ if b == id => group.face(b, a) == Some(face),
                _ => false,
            })
        })
    }

    /// Bonds two blocks of different groups.
    ///
    /// Moves `b` and its group to `seat` on `a`. Both groups are shifted and turned so that their
    /// common centre stays and there is no net rotation. From then on, they move as one body. The
    /// total momentum and angular momentum stay the same.
    pub fn join(
        &mut self,
        a: u32,
        b: u32,
        seat: &Pose,
        blocks: &mut impl Blocks,
        response: Response,
    ) {
        let was = blocks.pose(b);
        let (mut members, mut bonds) = self.take(a);
        let (moved, others) = self.take(b);
        let stay = members.len();
        members.extend(moved);
        bonds.extend(others);
        bonds.push((a, b));
        let motions: Vec<Motion> = members.iter().map(|&id| blocks.motion(id)).collect();
        let (mut compound, turning) = RigidMotion::momenta(&motions, response);
        let poses = members.iter().enumerate().map(|(index, &id)| {
            let pose = blocks.pose(id);
            if index < stay {
                [pose, pose]
            } else {
                [pose, pose.carried(&was, seat)]
            }
        });
        let poses: Vec<[Pose; 2]> = poses.collect();
        for (&id, pose) in members.iter().zip(rigid_motion::without_drift(&poses)) {
            blocks.set_pose(id, &pose);
        }
        if let Some(key) = self.add(members, bonds, blocks) {
            // Without a test of loads: bonding itself never breaks bonds.
            let group = &self.groups[&key];
            let arms = group.members.iter().map(|member| member.offset);
            compound.spin = rigid_motion::spin(turning, arms, response);
            group.stiffen(&compound, &group.motions(blocks), blocks);
        }
    }

    /// Removes a block from its group, which may split. Returns the blocks that it was bonded to.
    pub fn remove(&mut self, id: u32, blocks: &mut impl Blocks) -> Vec<u32> {
        if !self.of.contains_key(&id) {
            return Vec::new();
        }
        let (members, bonds) = self.take(id);
        let other = |&(a, b): &(u32, u32)| match id {
            _ if a == id => Some(b),
            _ if b == id => Some(a),
            _ => None,
        };
        let neighbours: Vec<u32> = bonds.iter().filter_map(other).collect();
        let bonds: Vec<_> = bonds
            .into_iter()
            .filter(|bond| other(bond).is_none())
            .collect();
        for part in parts(members.into_iter().filter(|&member| member != id), &bonds) {
            self.add(part.0, part.1, blocks);
        }
        neighbours
    }

    /// Gives each group a rigid motion and breaks bonds whose load exceeds `hold` \[block lengths /
    /// tick^2\]. Returns the number of broken bonds.
    pub fn settle(
        &mut self,
        blocks: &mut impl Blocks,
        hold: f64,
        response: Response,
        dt: f64,
    ) -> usize {
        let mut torn = 0;
        let mut todo: Vec<u32> = self.groups.keys().copied().collect();
        while let Some(key) = todo.pop() {
            let Some(group) = self.groups.get(&key) else {
                continue;
            };
            let before = group.motions(blocks);
            let compound = RigidMotion::new(&before, response);
            let worst = bond_load::worst(group, &before, &compound, response, dt);
            if let Some((bond, load)) = worst
                && load > hold
            {
                torn += 1;
                let (a, b) = group.bonds[bond];
                self.parted.insert((a.min(b), a.max(b)));
                let (members, mut bonds) = self.take(a);
                bonds.remove(bond);
                for (members, bonds) in parts(members.into_iter(), &bonds) {
                    todo.extend(self.add(members, bonds, blocks));
                }
                continue;
            }
            group.stiffen(&compound, &before, blocks);
        }
        torn
    }

    /// Gives each group a rigid motion, without a test of bond loads.
    pub fn stiffen(&self, blocks: &mut impl Blocks, response: Response) {
        for group in self.groups.values() {
            let before = group.motions(blocks);
            group.stiffen(&RigidMotion::new(&before, response), &before, blocks);
        }
    }

    /// Restores the shape of each group after its blocks were moved separately. The group rotates
    /// by its spin for a time `dt`.
    pub fn carry(&mut self, blocks: &mut impl Blocks, response: Response, dt: f64) {
        for group in self.groups.values_mut() {
            let motions = group.motions(blocks);
            // The blocks moved straight, so the group's angular momentum is unchanged. Its shape is
            // restored.
            let (mut compound, turning) = RigidMotion::momenta(&motions, response);
            let spin = |rotation: UnitQuaternion<f64>, members: &[GroupMember]| {
                rigid_motion::spin(
                    turning,
                    members.iter().map(|member| rotation * member.offset),
                    response,
                )
            };
            let rotation_vector = spin(group.rotation, &group.members) * dt;
            let turned = UnitQuaternion::from_scaled_axis(rotation_vector) * group.rotation;
            group.rotation = UnitQuaternion::new_normalize(turned.into_inner());
            compound.spin = spin(group.rotation, &group.members);
            for member in &group.members {
                let position = compound.middle + group.rotation * member.offset;
                let rotation = group.rotation * member.turn;
                blocks.set_pose(member.id, &Pose { position, rotation });
                let (velocity, spin) = compound.at(position);
                blocks.set_motion(member.id, velocity, spin);
            }
        }
    }

    /// Dissolves the group of a block and returns its members and bonds. Returns only the block
    /// itself if it has no group.
    pub(super) fn take(&mut self, id: u32) -> Part {
        let Some(group) = self.of.get(&id).and_then(|key| self.groups.remove(key)) else {
            return (vec![id], Vec::new());
        };
        for member in &group.members {
            self.of.remove(&member.id);
        }
        let ids = group.members.iter().map(|member| member.id).collect();
        (ids, group.bonds)
    }

    /// Makes a group of blocks at their current places. Returns the group's key, or `None` for a
    /// lone block.
    fn add(
        &mut self,
        mut ids: Vec<u32>,
        bonds: Vec<(u32, u32)>,
        blocks: &mut impl Blocks,
    ) -> Option<u32> {
        ids.sort_unstable();
        let &[key, _, ..] = &ids[..] else {
            return None;
        };
        let motions: Vec<Motion> = ids.iter().map(|&id| blocks.motion(id)).collect();
        let (RigidMotion { middle, .. }, _) = RigidMotion::momenta(&motions, Response::FREE);
        let members = ids.iter().map(|&id| {
            let pose = blocks.pose(id);
            GroupMember {
                id,
                offset: pose.position - middle,
                turn: pose.rotation,
            }
        });
        let group = BlockGroup {
            members: members.collect(),
            bonds,
            rotation: UnitQuaternion::identity(),
        };
        for &id in &ids {
            self.of.insert(id, key);
        }
        self.groups.insert(key, group);
        Some(key)
    }
}

/// Connected part of a group: the members, and the bonds between them.
type Part = (Vec<u32>, Vec<(u32, u32)>);

/// Returns the connected parts of a forest of bonds.
fn parts(members: impl Iterator<Item = u32>, bonds: &[(u32, u32)]) -> Vec<Part> {
    let mut left: BTreeSet<u32> = members.collect();
    let mut out = Vec::new();
    while let Some(first) = left.pop_first() {
        let part = connected(first, bonds);
        left.retain(|id| !part.contains(id));
        let own = |bond: &&(u32, u32)| part.contains(&bond.0);
        let bonds = bonds.iter().filter(own).copied().collect();
        out.push((part, bonds));
    }
    out
}
