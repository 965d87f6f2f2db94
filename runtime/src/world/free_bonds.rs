//! Free blocks whose magnets always attract: they pull each other, bond, move as groups, and break
//! apart.
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;

use super::blocks::{Blocks, Motion, Pose};
use super::bonding::pair_attraction::{FacePair, close, energy, seat};
use super::external_forces::Response;
use super::groups::{BlockGroups, lost};
use super::parameters::{Attraction, Magnet, Passive};

#[derive(Debug)]
pub(crate) struct FreeBonds {
    magnet: Magnet,
    passive: Passive,
    /// Effect of a constant force over one step, as a fraction of its effect without drag.
    response: Response,
    pub groups: BlockGroups,
    /// Velocity changes of rejected blocks, applied in the next step.
    impulses: BTreeMap<u32, Vector3<f64>>,
}

stochc_ir::state! {
    () FreeBonds;
    values: groups, impulses;
    parts: ;
    same: magnet, passive, response
}

impl FreeBonds {
    /// Returns an empty set of bonds, or `None` if faces do not always attract.
    pub fn new(magnet: &Magnet, response: Response) -> Option<FreeBonds> {
        let Attraction::Passive(passive) = magnet.law else {
            return None;
        };
        Some(FreeBonds {
            magnet: *magnet,
            passive,
            response,
            groups: BlockGroups::default(),
            impulses: BTreeMap::new(),
        })
    }

    /// Applies the attraction between free blocks to their velocities, and to their spins unless
    /// `turns` is false.
    pub fn pull(&self, free: &[u32], blocks: &mut impl Blocks, dt: f64, turns: bool) {
        let positions = positions(free, blocks);
        for (a, b) in close(&positions, self.passive.within) {
            let (a, b) = (positions[a].0, positions[b].0);
            if self.groups.same(a, b) {
                continue;
            }
            let (first, second) = (blocks.pose(a), blocks.pose(b));
            let pair = FacePair::new(&first, &second);
            let Some(pushes) = pair.pushes(&self.magnet, &first, &second) else {
                continue;
            };
            for (id, push) in [a, b].into_iter().zip(pushes) {
                let Motion { velocity, spin, .. } = blocks.motion(id);
                let velocity = velocity + push.linear * (dt * self.response.linear);
                let spin = if turns {
                    spin + push.angular * (dt * self.response.angular)
                } else {
                    spin
                };
                blocks.set_motion(id, velocity, spin);
            }
        }
    }

    /// Makes each group move as one body under the forces of a step, and breaks overloaded bonds.
    /// These forces exclude random impulses and Brownian motion. Then pushes rejected blocks away.
    pub fn settle(&mut self, blocks: &mut impl Blocks, dt: f64) {
        (self.groups).settle(blocks, self.passive.hold, self.response, dt);
        self.push_away(blocks);
    }

    /// Rejects a block. Its impulse is applied after drag and after the test of bonds. The impulse
    /// is instantaneous, so bonds need not transmit it.
    pub fn reject(&mut self, id: u32, impulse: Vector3<f64>) {
        *self.impulses.entry(id).or_default() += impulse;
    }

    fn push_away(&mut self, blocks: &mut impl Blocks) {
        if self.impulses.is_empty() {
            return;
        }
        for (id, impulse) in std::mem::take(&mut self.impulses) {
            let Motion { velocity, spin, .. } = blocks.motion(id);
            blocks.set_motion(id, velocity + impulse, spin);
        }
        self.stiffen(blocks);
    }

    /// Gives each group a rigid motion, without a test of bond loads.
    pub fn stiffen(&self, blocks: &mut impl Blocks) {
        self.groups.stiffen(blocks, self.response);
    }

    /// Moves each group as one body after its blocks were moved one by one.
    pub fn carry(&mut self, blocks: &mut impl Blocks, dt: f64) {
        self.groups.carry(blocks, self.response, dt);
    }

    /// Returns whether blocks bond only at the end of a tick.
    pub fn are_sampled(&self) -> bool {
        self.magnet.sampled
    }

    /// Bonds blocks that were close and straight enough during the step of length `dt` that has
    /// just ended.
    ///
    /// Skips pairs whose bond would dissipate more energy than it can absorb. Returns whether any
    /// pair bonded and was moved into place.
    pub fn join(&mut self, free: &[u32], blocks: &mut impl Blocks, dt: f64) -> bool {
        let positions = positions(free, blocks);
        let mut parting = BTreeSet::new();
        let mut ready = Vec::new();
        // Blocks that were close during the step are now at most the sum of their paths apart.
        let fastest = positions
            .iter()
            .map(|&(id, _)| blocks.motion(id).velocity.norm());
        let distance = 2.0 * dt * fastest.fold(0.0, f64::max);
        for (i, j) in close(&positions, self.magnet.anchoring() + distance) {
            let (a, b) = (positions[i].0, positions[j].0);
            let (first, second) = (blocks.pose(a), blocks.pose(b));
            let (one, other) = (blocks.motion(a), blocks.motion(b));
            let pair = FacePair::new(&first, &second);
            if pair.bonds(&self.magnet, [(&first, &one), (&second, &other)], dt) {
                // A broken pair may bond again once it separates no faster than its magnets can
                // stop in a step, after drag.
                let direction = (positions[j].1 - positions[i].1).normalize();
                let turning = other.spin - one.spin;
                // Separation speed of the centres, or of two edges.
                let opening = (other.velocity - one.velocity).dot(&direction)
                    + 0.5 * (turning - direction * turning.dot(&direction)).norm();
                if opening > self.passive.hold * dt * self.response.linear {
                    parting.insert((a, b));
                }
                ready.push((a, b, pair));
            }
        }
        self.groups.forgive(&parting);
        let mut joined = false;
        for (a, b, pair) in ready {
            if self.groups.same(a, b) || self.groups.are_parted(a, b) {
                continue;
            }
            let seat = seat(&blocks.pose(a), pair.face, &blocks.pose(b), pair.other);
            if !self.groups.have_room(a, b, &seat, blocks) {
                continue;
            }
            let motions: Vec<Motion> = [a, b]
                .into_iter()
                .flat_map(|id| self.groups.with(id))
                .map(|id| blocks.motion(id))
                .collect();
            if lost(&motions) < energy(&self.passive) {
                self.groups.join(a, b, &seat, blocks, self.response);
                joined = true;
            }
        }
        joined
    }

    /// Removes a block that the structure has captured. Its former neighbours are rejected and
    /// returned.
    pub fn leave(&mut self, id: u32, blocks: &mut impl Blocks) -> Vec<u32> {
        self.impulses.remove(&id);
        let from = blocks.exact_position(id);
        let neighbours = self.groups.remove(id, blocks);
        for &neighbour in &neighbours {
            let displacement = blocks.exact_position(neighbour) - from;
            self.reject(
                neighbour,
                displacement * (self.passive.impulse / displacement.norm().max(1e-9)),
            );
        }
        neighbours
    }
}

fn positions(free: &[u32], blocks: &mut impl Blocks) -> Vec<(u32, Vector3<f64>)> {
    let located = |&id: &u32| {
        let Pose { position, .. } = blocks.pose(id);
        (id, position)
    };
    free.iter().map(located).collect()
}
