//! Which blocks are near each other, looked up once for several substeps (Verlet 1967).
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::bodies::Bodies;
use super::cell_list::{CellList, TOUCH};
use super::simd::{LANES, Lane, Wide, square};
use crate::world::blocks::Blocks;
use crate::world::motion_limits::FARTHEST;

/// So much farther apart than touching \[side\], pairs are on a list that is to last.
const SKIN: f64 = 1.6;

/// More than rounding can change a distance by \[side\].
const ROUNDING: f64 = 0.01;

/// A list has to last for so many steps, or it costs more than it saves.
const LASTING: f64 = 2.5;

/// Steps until it is looked again how long a list would last, and how far blocks have spread.
const REVIEW: u32 = 64;

/// At most one block in so many may be outside of the grid, where cells are crowded.
const OUTSIDE: usize = 8;

/// The blocks near each other and near places.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub(super) struct NeighbourList<R: Lane> {
    /// The blocks mostly stay within this of the origin, and above the floor if there is one \[side\].
    span: f64,
    floor: Option<f64>,
    /// So high does the grid reach, below which most blocks are: a sediment, or a flat structure, would crowd the lowest cells
    /// of a higher one \[side\].
    top: f64,
    grid: CellList<R>,
    /// [`SKIN`], or 0: there is no list, and everybody is looked up in every step.
    skin: f64,
    pairs: Vec<(u32, u32)>,
    /// How far apart each of them was when the list was made, and by how much any two blocks have come closer since, at
    /// most \[side\].
    distances: Vec<R>,
    closer: R,
    /// Where the blocks were when the list was made, in the same groups; empty: there is none.
    places: Vec<[[R; LANES]; 3]>,
    /// Steps until the next review.
    due: u32,
}

impl<R: Lane> NeighbourList<R> {
    /// For blocks that mostly stay within `span` of the origin so far, and above `floor` \[side\].
    pub fn new(count: usize, span: f64, floor: Option<f64>) -> NeighbourList<R> {
        let heights = [floor.unwrap_or(-span), span];
        NeighbourList {
            span,
            floor,
            top: span,
            grid: CellList::new(count, span, heights, TOUCH + SKIN),
            skin: SKIN,
            pairs: Vec::new(),
            distances: Vec::new(),
            closer: R::zero(),
            places: Vec::new(),
            due: 0,
        }
    }

    /// Takes in where the blocks are now; whether they had to be looked up anew.
    pub fn follow(&mut self, bodies: &Bodies<R>) -> bool {
        match self.due.checked_sub(1) {
            Some(due) => self.due = due,
            None => self.review(bodies),
        }
        if !self.places.is_empty() && self.holds(bodies) {
            return false;
        }
        self.grid.sort(bodies);
        if self.skin > 0.0 {
            self.places.clear();
            let places = bodies.groups().iter().map(|group| group.position);
            self.places.extend(places);
            self.grid.close_pairs(&mut self.pairs);
            let way = |&(i, j): &(u32, u32)| bodies.position(i) - bodies.position(j);
            self.distances.clear();
            let distances = self.pairs.iter().map(|pair| way(pair).norm());
            self.distances.extend(distances);
            self.closer = R::zero();
        }
        true
    }

    /// A block that was anchored is free: its pairs with others that still are may not be listed.
    pub fn forget(&mut self) {
        self.places.clear();
    }

    /// Decides whether there is to be a list, and how far the grid reaches.
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
        while span < FARTHEST && bodies.count_beyond(R::of(span)) > outside {
            span *= 1.5;
        }
        let (mut top, near) = (span, TOUCH + skin);
        if let Some(floor) = self.floor {
            let middle = |top: f64| floor.midpoint(top);
            while middle(top) > floor + near && bodies.count_above(R::of(middle(top))) <= outside {
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

    /// Sees how far blocks have moved; whether no two of them have come closer by the skin.
    fn holds(&mut self, bodies: &Bodies<R>) -> bool {
        let load = |x: &[R; LANES]| R::Wide::load(x);
        let [mut farthest, mut second] = [R::Wide::splat(R::zero()); 2];
        for (group, then) in bodies.groups().iter().zip(&self.places) {
            let way = [0, 1, 2].map(|axis| load(&group.position[axis]) - load(&then[axis]));
            let way = square(way);
            second = second.maximum(way.minimum(farthest));
            farthest = way.maximum(farthest);
        }
        let mut two = [R::zero(); 2];
        for way in farthest.store().into_iter().chain(second.store()) {
            let [most, next] = two;
            two = [most.max(way), next.max(way.min(most))];
        }
        self.closer = two[0].sqrt() + two[1].sqrt();
        self.closer < R::of(self.skin)
    }

    /// Every pair of blocks that may touch, but those of which both are anchored; once, the lower
    /// number first, in rising order.
    pub fn close_pairs(&mut self, bodies: &Bodies<R>, pairs: &mut Vec<(u32, u32)>) {
        if self.skin == 0.0 {
            self.grid.close_pairs(pairs);
            return;
        }
        let touch = R::of(TOUCH * TOUCH);
        pairs.clear();
        // Farther apart than this then, they do not touch now, whatever rounding does.
        let far = R::of(TOUCH + ROUNDING) + self.closer;
        for (&(i, j), &distance) in self.pairs.iter().zip(&self.distances) {
            if distance > far {
                continue;
            }
            let way = bodies.position(i) - bodies.position(j);
            if way.norm_squared() < touch {
                pairs.push((i, j));
            }
        }
    }

    /// The blocks that may come within `reach` of a place before the list is made anew, in rising
    /// order.
    pub fn around(&self, centre: Vector3<R>, reach: R, found: &mut Vec<u32>) {
        self.grid.around(centre, reach + R::of(self.skin), found);
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::world::BodyState;

    /// Against every pair asked, while blocks are slow enough for a list by times.
    #[test]
    fn no_pair_is_lost_when_blocks_get_faster_and_slower() {
        let mut dice = ChaCha8Rng::seed_from_u64(1);
        let mut vector = |size: f64| Vector3::from_fn(|_, _| dice.random_range(-size..size));
        let blocks: Vec<BodyState> = (0..60).map(|_| BodyState::at_rest(vector(5.0))).collect();
        let mut bodies = Bodies::<f32>::new(&blocks, 1.0, 1.0);
        let mut neighbours = NeighbourList::new(blocks.len(), 2.0, None);
        let (mut found, mut lists, mut without) = (Vec::new(), 0, 0);
        for step in 0..1000 {
            let speed = [0.02, 0.6][step / 200 % 2];
            for id in 0..bodies.count() {
                let home = bodies.position(id) * -0.01;
                let velocity = vector(speed).map(|v| v as f32) + home;
                bodies.set_velocity(id, velocity, Vector3::zeros());
                bodies.set_position(id, bodies.position(id) + velocity);
            }
            let anew = neighbours.follow(&bodies);
            lists += u32::from(!anew);
            without += u32::from(neighbours.skin == 0.0);
            neighbours.close_pairs(&bodies, &mut found);
            let all = (0..60).flat_map(|i| (i + 1..60).map(move |j| (i, j)));
            let near = |&(i, j): &(u32, u32)| {
                let way = bodies.position(i) - bodies.position(j);
                way.norm_squared() < (TOUCH * TOUCH) as f32
            };
            assert_eq!(found, all.filter(near).collect::<Vec<_>>(), "step {step}");
        }
        assert!(lists > 300 && without > 200, "{lists} {without}");
    }
}
