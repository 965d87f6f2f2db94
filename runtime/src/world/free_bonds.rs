//! Free blocks with magnets that always attract: they pull each other, bond, move as groups, and are torn apart.
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Vector3;

use super::blocks::{Blocks, Motion, Pose};
use super::bonding::pair_attraction::{FacePair, close, energy, seat};
use super::external_forces::Response;
use super::groups::{BlockGroups, lost};
use super::parameters::{Attraction, Magnet, Passive};

/// Bonds without a structure.
#[derive(Debug)]
pub(crate) struct FreeBonds {
    magnet: Magnet,
    passive: Passive,
    /// How much of a force's effect is left in a step.
    response: Response,
    pub groups: BlockGroups,
    /// What rejected blocks get in the next step: changes of velocity.
    impulses: BTreeMap<u32, Vector3<f64>>,
}

stochc_ir::state! {
    () FreeBonds;
    values: groups, impulses;
    parts: ;
    same: magnet, passive, response
}

impl FreeBonds {
    /// `None` where faces do not attract by themselves.
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

    /// What the free blocks do to each other's velocities in a step, and, if blocks turn at all, to their spins.
    pub fn pull(&self, free: &[u32], blocks: &mut impl Blocks, dt: f64, turns: bool) {
        let places = places(free, blocks);
        for (a, b) in close(&places, self.passive.within) {
            let (a, b) = (places[a].0, places[b].0);
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

    /// All forces of a step but kicks and heat have acted: groups take them up as one body, or are torn. Then those that have
    /// been rejected are pushed away.
    pub fn settle(&mut self, blocks: &mut impl Blocks, dt: f64) {
        (self.groups).settle(blocks, self.passive.hold, self.response, dt);
        self.push_away(blocks);
    }

    /// A block is rejected. What it gets is kept until the drag of the step has acted, which has no part in it, and the bonds
    /// have been looked at: it is over at once, and no force that they have to hold.
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

    /// Groups take up as one body what has acted since, whatever their bonds hold.
    pub fn stiffen(&self, blocks: &mut impl Blocks) {
        self.groups.stiffen(blocks, self.response);
    }

    /// Blocks have been moved one by one.
    pub fn carry(&mut self, blocks: &mut impl Blocks, dt: f64) {
        self.groups.carry(blocks, self.response, dt);
    }

    /// Whether blocks bond at the end of a tick only.
    pub fn are_sampled(&self) -> bool {
        self.magnet.sampled
    }

    /// Bonds the blocks that are close and straight enough, or were in the step of length `dt` that ends here, unless more energy
    /// would have to go than the bond can take up; whether some did, and were moved into their places.
    pub fn join(&mut self, free: &[u32], blocks: &mut impl Blocks, dt: f64) -> bool {
        let places = places(free, blocks);
        let mut parting = BTreeSet::new();
        let mut ready = Vec::new();
        // Two that have been close in the step are no farther apart now than both have come.
        let fastest = places
            .iter()
            .map(|&(id, _)| blocks.motion(id).velocity.norm());
        let way = 2.0 * dt * fastest.fold(0.0, f64::max);
        for (i, j) in close(&places, self.magnet.anchoring() + way) {
            let (a, b) = (places[i].0, places[j].0);
            let (first, second) = (blocks.pose(a), blocks.pose(b));
            let (one, other) = (blocks.motion(a), blocks.motion(b));
            let pair = FacePair::new(&first, &second);
            if pair.bonds(&self.magnet, [(&first, &one), (&second, &other)], dt) {
                // A pair that has been torn is let bond again when it parts no faster than its magnets can stop
                // in a step, of which drag takes its part.
                let way = (places[j].1 - places[i].1).normalize();
                let turning = other.spin - one.spin;
                // Their middles, or two of their edges.
                let opening = (other.velocity - one.velocity).dot(&way)
                    + 0.5 * (turning - way * turning.dot(&way)).norm();
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

    /// A structure has taken a block, which rejects what hangs on it: who that is.
    pub fn leave(&mut self, id: u32, blocks: &mut impl Blocks) -> Vec<u32> {
        self.impulses.remove(&id);
        let from = blocks.exact_position(id);
        let neighbours = self.groups.remove(id, blocks);
        for &neighbour in &neighbours {
            let way = blocks.exact_position(neighbour) - from;
            self.reject(
                neighbour,
                way * (self.passive.impulse / way.norm().max(1e-9)),
            );
        }
        neighbours
    }
}

fn places(free: &[u32], blocks: &mut impl Blocks) -> Vec<(u32, Vector3<f64>)> {
    let place = |&id: &u32| {
        let Pose { position, .. } = blocks.pose(id);
        (id, position)
    };
    free.iter().map(place).collect()
}
