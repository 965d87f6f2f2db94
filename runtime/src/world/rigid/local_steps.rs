//! Local time steps: short steps for blocks in the field of a magnetized face, and for blocks that
//! may touch them.
//!
//! All others move once per long step. The contact force on a pair acts at the longer of the two
//! steps, with equal and opposite impulses, so momentum is conserved. The selection depends on
//! positions, velocities and open faces at the beginning of a long step.
use serde::{Deserialize, Serialize};

use super::bodies::Bodies;
use super::cell_list::TOUCH;
use super::neighbour_list::NeighbourList;
use super::simd::Lane;
use crate::world::blocks::Blocks;
use crate::world::real::Real;

/// Allowance for velocity changes by contacts and magnets within a step \[block lengths\].
pub(super) const SURPRISE: f64 = 0.1;

/// Blocks that take short steps within a long one.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub(super) struct LocalSteps<R: Real> {
    /// Lengths of a long and a short step \[tick\].
    long: R,
    short: R,
    /// Blocks with short steps in rising order, in this long step and in the previous one.
    pub blocks: Vec<u32>,
    before: Vec<u32>,
    /// Pairs of these blocks, and pairs with anchored blocks, that may touch in the long step. The
    /// lower number first, in rising order.
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

    /// Returns the largest path of a block in a long step.
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
            let place = bodies.position(id);
            neighbours.around(place, reach(bodies, id) + most, &mut found);
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
            let place = bodies.position(id);
            neighbours.around(place, reach(bodies, id) + most, &mut found);
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
