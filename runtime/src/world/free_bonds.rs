//! Free blocks with magnets that always attract: they pull each other, bond, move as groups, and are torn apart.
use std::collections::BTreeSet;

use nalgebra::Vector3;

use super::ambient::{Motion, Response};
use super::groups::{Flock, Groups, lost};
use super::magnet::pairs::{Pose, close, energy, meet, seat};
use super::terms::{Attraction, Magnet, Passive};

/// Bonds without a structure.
#[derive(Debug)]
pub(crate) struct FreeBonds {
    magnet: Magnet,
    passive: Passive,
    pub groups: Groups,
}

impl FreeBonds {
    /// `None` where faces do not attract by themselves.
    pub fn new(magnet: &Magnet) -> Option<FreeBonds> {
        let Attraction::Passive(passive) = magnet.law else {
            return None;
        };
        Some(FreeBonds {
            magnet: *magnet,
            passive,
            groups: Groups::default(),
        })
    }

    /// What the free blocks do to each other's velocities in a step.
    pub fn pull(&self, free: &[u32], flock: &mut impl Flock, dt: f64, response: Response) {
        let places = places(free, flock);
        for (a, b) in close(&places, self.passive.within) {
            let (a, b) = (places[a].0, places[b].0);
            if self.groups.same(a, b) {
                continue;
            }
            let Some(met) = meet(&self.magnet, &flock.pose(a), &flock.pose(b)) else {
                continue;
            };
            for (id, push) in [(a, met.pushes[0]), (b, met.pushes[1])] {
                let Motion { velocity, spin, .. } = flock.motion(id);
                let linear = push.linear * (dt * response.linear);
                let angular = push.angular * (dt * response.angular);
                flock.set_velocity(id, velocity + linear, spin + angular);
            }
        }
    }

    /// All forces of a step have acted: groups take them up as one body, or are torn.
    pub fn settle(&mut self, flock: &mut impl Flock, dt: f64, response: Response) {
        self.groups.settle(flock, self.passive.hold, response, dt);
    }

    /// Blocks have been moved one by one.
    pub fn carry(&mut self, flock: &mut impl Flock, dt: f64) {
        self.groups.carry(flock, dt);
    }

    /// Bonds the blocks that are close and straight enough, unless more energy would have to go than the bond can
    /// take up; whether some did, and were moved into their places.
    pub fn join(&mut self, free: &[u32], flock: &mut impl Flock, dt: f64) -> bool {
        let places = places(free, flock);
        let mut parting = BTreeSet::new();
        let mut ready = Vec::new();
        for (i, j) in close(&places, self.magnet.anchoring()) {
            let (a, b) = (places[i].0, places[j].0);
            if let Some(met) = meet(&self.magnet, &flock.pose(a), &flock.pose(b))
                && met.bonds
            {
                // A pair that has been torn is let bond again when it parts no faster than its magnets can stop
                // in a step.
                let way = (places[j].1 - places[i].1).normalize();
                let (one, other) = (flock.motion(a), flock.motion(b));
                let turning = other.spin - one.spin;
                // Their middles, or two of their edges.
                let opening = (other.velocity - one.velocity).dot(&way)
                    + 0.5 * (turning - way * turning.dot(&way)).norm();
                if opening > self.passive.hold * dt {
                    parting.insert((a, b));
                }
                ready.push((a, b, met));
            }
        }
        self.groups.forgive(&parting);
        let mut joined = false;
        for (a, b, met) in ready {
            if self.groups.same(a, b) || self.groups.are_parted(a, b) {
                continue;
            }
            let motions: Vec<Motion> = [a, b]
                .into_iter()
                .flat_map(|id| self.groups.with(id))
                .map(|id| flock.motion(id))
                .collect();
            if lost(&motions) < energy(&self.passive) {
                let seat = seat(&flock.pose(a), met.face, &flock.pose(b), met.other);
                self.groups.join(a, b, &seat, flock);
                joined = true;
            }
        }
        joined
    }

    /// A structure has taken a block, which rejects what hangs on it: who that is.
    pub fn leave(&mut self, id: u32, flock: &mut impl Flock) -> Vec<u32> {
        let from = flock.pose(id).position;
        let neighbours = self.groups.remove(id, flock);
        for &neighbour in &neighbours {
            let Motion {
                position,
                velocity,
                spin,
            } = flock.motion(neighbour);
            let way = position - from;
            let kick = way * (self.passive.impulse / way.norm().max(1e-9));
            flock.set_velocity(neighbour, velocity + kick, spin);
        }
        neighbours
    }
}

fn places(free: &[u32], flock: &mut impl Flock) -> Vec<(u32, Vector3<f64>)> {
    let place = |&id: &u32| {
        let Pose { position, .. } = flock.pose(id);
        (id, position)
    };
    free.iter().map(place).collect()
}
