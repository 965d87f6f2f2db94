//! Local time steps. Blocks in the field of a magnetized face take short steps, as do blocks that
//! may touch them.
//!
//! All other blocks move once per long step. The contact force on a pair acts over the longer of
//! its two steps, with equal and opposite impulses. This conserves momentum. The selection depends
//! on positions, velocities and open faces at the beginning of a long step.
use serde::{Deserialize, Serialize};

use super::bodies::Bodies;
use super::cell_list::TOUCH;
use super::neighbour_list::NeighbourList;
use super::simd::Lane;
use crate::world::blocks::Blocks;
use crate::world::real::Real;

/// Allowance for the change of a block's path in a step by contacts and magnets \[block lengths\].
pub(super) const SURPRISE: f64 = 0.1;

/// Selection of the blocks that take short steps within a long step.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub(super) struct LocalSteps<R: Real> {
    /// Length of a long step \[tick\].
    long: R,
    /// Length of a short step \[tick\].
    short: R,
    /// Blocks with short steps in this long step, in ascending order.
    pub blocks: Vec<u32>,
    /// Blocks with short steps in the previous long step, in ascending order.
    before: Vec<u32>,
    /// Pairs that may touch in the long step: two of `blocks`, or one of them and an anchored
    /// block. The lower number comes first; pairs are in ascending order.
    pub pairs: Vec<(u32, u32)>,
    found: Vec<u32>,
}

impl<R: Lane> LocalSteps<R> {
    pub fn new([long, short]: [f64; 2]) -> LocalSteps<R> {
        LocalSteps {
            long: R::from_double(long),
            short: R::from_double(short),
            blocks: Vec::new(),
            before: Vec::new(),
            pairs: Vec::new(),
            found: Vec::new(),
        }
    }

    /// Returns the longest path that a block with this speed may take in a long step \[block
    /// lengths\].
    pub fn distance(&self, speed: R) -> R {
        speed * self.long + R::from_double(SURPRISE)
    }

    /// Begins a long step. During it, the blocks `in_field` may enter the field of a face.
    pub fn begin(
        &mut self,
        bodies: &mut Bodies<R>,
        neighbours: &NeighbourList<R>,
        in_field: &[u32],
    ) {
        for &id in &self.before {
            bodies.set_last(id, self.long);
        }
        for &id in &self.blocks {
            bodies.set_last(id, self.short);
            bodies.set_step(id, self.long);
        }
        std::mem::swap(&mut self.before, &mut self.blocks);
        self.blocks.clear();
        self.blocks.extend_from_slice(in_field);
        let (long, most) = (self.long, self.distance(bodies.fastest()));
        let distance = |bodies: &Bodies<R>, id: u32| {
            bodies.velocity(id).norm() * long + R::from_double(SURPRISE)
        };
        let reach = |bodies: &Bodies<R>, id: u32| R::from_double(TOUCH) + distance(bodies, id);
        let near = |bodies: &Bodies<R>, id: u32, other: u32| {
            let most = reach(bodies, id) + distance(bodies, other);
            (bodies.position(other) - bodies.position(id)).norm_squared() < most * most
        };
        let mut found = std::mem::take(&mut self.found);
        for &id in in_field {
            let position = bodies.position(id);
            neighbours.around(position, reach(bodies, id) + most, &mut found);
            found.retain(|&other| bodies.is_free(other) && near(bodies, id, other));
            self.blocks.extend_from_slice(&found);
        }
        self.blocks.sort_unstable();
        self.blocks.dedup();
        for &id in &self.blocks {
            bodies.set_step(id, self.short);
        }
        self.pairs.clear();
        for &id in &self.blocks {
            let position = bodies.position(id);
            neighbours.around(position, reach(bodies, id) + most, &mut found);
            found.retain(|&other| {
                let is_partner = if bodies.is_free(other) {
                    other > id && bodies.step(other) == self.short
                } else {
                    true
                };
                is_partner && near(bodies, id, other)
            });
            let pairs = found.iter().map(|&other| (id.min(other), id.max(other)));
            self.pairs.extend(pairs);
        }
        self.pairs.sort_unstable();
        self.found = found;
    }

    /// Records that the first short step is complete.
    pub fn has_begun(&self, bodies: &mut Bodies<R>) {
        for &id in &self.blocks {
            bodies.set_last(id, self.short);
        }
    }
}
