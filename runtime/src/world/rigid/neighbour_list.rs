//! Neighbour list: nearby pairs of blocks, valid for several substeps.
//!
//! # Source
//!
//! L. Verlet (1967).
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::bodies::Bodies;
use super::cell_list::{CellList, TOUCH};
use super::simd::{LANES, Lane, Wide, square};
use crate::world::blocks::Blocks;
use crate::world::motion_limits::FARTHEST;

/// Largest gap between the blocks of a listed pair \[block lengths\].
const SKIN: f64 = 1.6;

/// Upper bound of rounding errors of a distance \[block lengths\].
const ROUNDING: f64 = 0.01;

/// Number of steps that a list must last to pay off.
const LASTING: f64 = 2.5;

/// Number of steps between reviews of the list's lifetime and of the blocks' extent.
const REVIEW: u32 = 64;

/// At most one in this many blocks may be outside the grid. More would crowd its outermost cells.
const OUTSIDE: usize = 8;

/// Index of the pairs of nearby blocks, and of the blocks near a position.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub(super) struct NeighbourList<R: Lane> {
    /// Half-width of the region with most blocks \[block lengths\].
    span: f64,
    floor: Option<f64>,
    /// Height of the grid \[block lengths\]. Few blocks are above it. A higher grid would crowd a
    /// sediment or a flat structure into its lowest cells.
    top: f64,
    /// Whether all blocks are in one horizontal plane.
    is_flat: bool,
    grid: CellList<R>,
    /// [`SKIN`], or 0 if all pairs are searched in every step.
    skin: f64,
    pairs: Vec<(u32, u32)>,
    /// Distance of each listed pair when the list was made \[block lengths\].
    distances: Vec<R>,
    /// Upper bound on how much closer any two blocks have come since the list was made \[block
    /// lengths\].
    closer: R,
    /// Positions when the list was made, in SIMD groups. Empty if there is no list.
    positions: Vec<[[R; LANES]; 3]>,
    /// Steps until the next review.
    due: u32,
}

impl<R: Lane> NeighbourList<R> {
    /// Returns an empty list for blocks mostly within `span` of the origin and above `floor`
    /// \[block lengths\].
    ///
    /// If `is_flat`, all blocks are in the first layer above the floor.
    pub fn new(count: usize, span: f64, floor: Option<f64>, is_flat: bool) -> NeighbourList<R> {
        let top = if is_flat { 1.0 } else { span };
        let heights = [floor.unwrap_or(-span), top];
        NeighbourList {
            span,
            floor,
            top,
            is_flat,
            grid: CellList::new(count, span, heights, TOUCH + SKIN),
            skin: SKIN,
            pairs: Vec::new(),
            distances: Vec::new(),
            closer: R::zero(),
            positions: Vec::new(),
            due: 0,
        }
    }

    /// Updates the list to the current positions. Returns whether it was rebuilt.
    pub fn follow(&mut self, bodies: &Bodies<R>) -> bool {
        match self.due.checked_sub(1) {
            Some(due) => self.due = due,
            None => self.review(bodies),
        }
        if !self.positions.is_empty() && self.holds(bodies) {
            return false;
        }
        self.grid.sort(bodies);
        if self.skin > 0.0 {
            self.positions.clear();
            let positions = bodies.groups().iter().map(|group| group.position);
            self.positions.extend(positions);
            self.grid.close_pairs(&mut self.pairs);
            let displacement = |&(i, j): &(u32, u32)| bodies.position(i) - bodies.position(j);
            self.distances.clear();
            let distances = self.pairs.iter().map(|pair| displacement(pair).norm());
            self.distances.extend(distances);
            self.closer = R::zero();
        }
        true
    }

    /// Invalidates the list after a release: pairs of a formerly anchored block may be missing.
    pub fn forget(&mut self) {
        self.positions.clear();
    }

    /// Decides whether to keep a list of pairs between steps, and adapts the size of the grid to
    /// the blocks. Invalidates the list if this changes anything.
    fn review(&mut self, bodies: &Bodies<R>) {
        self.due = REVIEW;
        let step = bodies.fastest().double() * bodies.dt.double();
        let skin = if step * LASTING < SKIN / 2.0 {
            SKIN
        } else {
            0.0
        };
        let outside = bodies.count() as usize / OUTSIDE;
        let mut span = self.span;
        while span < FARTHEST && bodies.count_beyond(R::from_double(span)) > outside {
            span *= 1.5;
        }
        let (mut top, near) = (span, TOUCH + skin);
        if self.is_flat {
            top = self.top;
        } else if let Some(floor) = self.floor {
            let middle = |top: f64| floor.midpoint(top);
            while middle(top) > floor + near
                && bodies.count_above(R::from_double(middle(top))) <= outside
            {
                top = middle(top);
            }
        }
        if (skin, span, top) != (self.skin, self.span, self.top) {
            (self.skin, self.span, self.top) = (skin, span, top);
            let heights = [self.floor.unwrap_or(-span), top];
            self.grid = CellList::new(bodies.count() as usize, span, heights, near);
            self.forget();
        }
    }

    /// Returns whether the list is valid: no two blocks have approached by more than the skin.
    fn holds(&mut self, bodies: &Bodies<R>) -> bool {
        let load = |x: &[R; LANES]| R::Wide::load(x);
        let [mut farthest, mut second] = [R::Wide::splat(R::zero()); 2];
        for (group, then) in bodies.groups().iter().zip(&self.positions) {
            let moved = [0, 1, 2].map(|axis| load(&group.position[axis]) - load(&then[axis]));
            let moved = square(moved);
            second = second.maximum(moved.minimum(farthest));
            farthest = moved.maximum(farthest);
        }
        let mut two = [R::zero(); 2];
        for moved in farthest.store().into_iter().chain(second.store()) {
            let [most, next] = two;
            two = [most.max(moved), next.max(moved.min(most))];
        }
        self.closer = two[0].sqrt() + two[1].sqrt();
        self.closer < R::from_double(self.skin)
    }

    /// Lists every pair of blocks that may touch, with at least one free block. Pairs are unique
    /// and in ascending order, the lower number first.
    pub fn close_pairs(&mut self, bodies: &Bodies<R>, pairs: &mut Vec<(u32, u32)>) {
        if self.skin == 0.0 {
            self.grid.close_pairs(pairs);
            return;
        }
        let touch = R::from_double(TOUCH * TOUCH);
        pairs.clear();
        // Pairs that were beyond this distance when the list was made cannot touch now.
        let far = R::from_double(TOUCH + ROUNDING) + self.closer;
        for (&(i, j), &distance) in self.pairs.iter().zip(&self.distances) {
            if distance > far {
                continue;
            }
            let displacement = bodies.position(i) - bodies.position(j);
            if displacement.norm_squared() < touch {
                pairs.push((i, j));
            }
        }
    }

    /// Lists the blocks that may come within `reach` of a position before the list is rebuilt, in
    /// ascending order.
    pub fn around(&self, centre: Vector3<R>, reach: R, found: &mut Vec<u32>) {
        self.grid
            .around(centre, reach + R::from_double(self.skin), found);
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::world::BodyState;

    /// Compares the pairs with the result of testing all pairs. The blocks are slow enough for a
    /// list only at some times.
    #[test]
    fn no_pair_is_lost_when_blocks_get_faster_and_slower() {
        let mut dice = ChaCha8Rng::seed_from_u64(1);
        let mut vector = |size: f64| Vector3::from_fn(|_, _| dice.random_range(-size..size));
        let blocks: Vec<BodyState> = (0..60).map(|_| BodyState::at_rest(vector(5.0))).collect();
        let mut bodies = Bodies::<f32>::new(&blocks, 1.0, 1.0);
        let mut neighbours = NeighbourList::new(blocks.len(), 2.0, None, false);
        let (mut found, mut lists, mut without) = (Vec::new(), 0, 0);
        for step in 0..1000 {
            let speed = [0.02, 0.6][step / 200 % 2];
            for id in 0..bodies.count() {
                let home = bodies.position(id) * -0.01;
                let velocity = vector(speed).map(|v| v as f32) + home;
                bodies.set_velocity(id, velocity, Vector3::zeros());
                bodies.set_position(id, bodies.position(id) + velocity);
            }
            let rebuilt = neighbours.follow(&bodies);
            lists += u32::from(!rebuilt);
            without += u32::from(neighbours.skin == 0.0);
            neighbours.close_pairs(&bodies, &mut found);
            let all = (0..60).flat_map(|i| (i + 1..60).map(move |j| (i, j)));
            let near = |&(i, j): &(u32, u32)| {
                let displacement = bodies.position(i) - bodies.position(j);
                displacement.norm_squared() < (TOUCH * TOUCH) as f32
            };
            assert_eq!(found, all.filter(near).collect::<Vec<_>>(), "step {step}");
        }
        assert!(lists > 300 && without > 200, "{lists} {without}");
    }
}
