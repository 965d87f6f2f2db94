//! Which blocks are near each other: blocks sorted by cells of a grid.
//!
//! Cells are long in x, and numbered along y first, so that the neighbours of a cell lie side by
//! side in the sorted list: of all cells that touch it, half are two stretches of that list, and
//! three more where a block is close to the end of its cell in x. Stretches are short, and asked
//! four blocks at once, whether or not anybody is there: a guess that fails would cost more.
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::bodies::Bodies;
use super::simd::{ABREAST, LANES, Lane, Wide};
use crate::world::blocks::Blocks;

/// Farther apart than this \[side\], the centres of two cubes: they do not touch.
pub(super) const TOUCH: f64 = 1.732_050_9;

/// Thickness of a cell, in units of the distance that counts as near, unless there would be too many.
const MARGIN: f64 = 1.005;

/// At most so many cells per block; with more, the cells grow.
const CELLS_PER_BLOCK: f64 = 2.0;

/// At least so many cells are allowed, and at most so many: they are numbered by floating point
/// numbers, too.
const FEW: f64 = 1024.0;
const MANY: f64 = 4_000_000.0;

/// The blocks by cells.
///
/// An empty cell is between two rows, and an empty row below and above each slab of cells: a
/// neighbour is a fixed number away. Blocks outside of the grid count as inside of its outermost
/// cells, which loses no neighbours.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub(super) struct CellList<R: Lane> {
    /// The middle of the first cell.
    low: [R; 3],
    /// Cells per side.
    scale: [R; 3],
    /// Closer than this is near \[side\].
    near: R,
    /// The last cell along each axis.
    last: [R; 3],
    /// Cells in a row along y, and in a slab of rows, with the empty ones.
    stride: [usize; 2],
    /// Where the blocks of a cell begin in the sorted list; the next one begins where they end.
    start: Vec<u32>,
    /// Anchored blocks in the cells before each one; empty unless most blocks are anchored.
    anchored: Vec<u32>,
    /// The cell of each block by number.
    cells: Vec<u32>,
    /// The blocks, sorted by cell and then by number: cell, who it is, and place.
    ///
    /// Places go on for [`ABREAST`] blocks that are nowhere.
    sorted: Vec<(u32, Tag)>,
    places: [Vec<R>; 3],
    /// Pairs as they are found, and where those of each block end: kept to be used again.
    #[serde(skip)]
    found: Vec<(u32, u32)>,
    #[serde(skip)]
    ends: Vec<u32>,
}

/// A block's number, and whether it is anchored.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Tag(u32);

impl Tag {
    fn new(id: u32, anchored: bool) -> Tag {
        Tag(id << 1 | u32::from(anchored))
    }

    fn id(self) -> u32 {
        self.0 >> 1
    }

    fn is_anchored(self) -> bool {
        self.0 & 1 == 1
    }

    fn are_anchored(self, other: Tag) -> bool {
        self.0 & other.0 & 1 == 1
    }
}

/// Turns counts into how many there are up to each.
fn sum_up(counts: &mut [u32]) {
    let mut sum = 0;
    for count in counts {
        sum += *count;
        *count = sum;
    }
}

impl<R: Lane> CellList<R> {
    /// For blocks that mostly stay within `span` of the origin, and between two heights, and of which
    /// those closer than `near` are looked for \[side\].
    pub fn new(count: usize, span: f64, [floor, top]: [f64; 2], near: f64) -> CellList<R> {
        let mut edge = near * MARGIN;
        let span = span.max(edge);
        let most = (count as f64 * CELLS_PER_BLOCK).clamp(FEW, MANY);
        let along = |length: f64, edge: f64| length / edge + 2.0;
        let rows = |edge: f64| along(2.0 * span, edge) * along(top - floor, edge);
        while rows(edge) > most {
            edge *= 1.1;
        }
        let slabs = (most / rows(edge)).min(2.0 * span / edge).max(1.0).floor();
        let length = 2.0 * span / slabs;
        let [wide, high] =
            [2.0 * span, top - floor].map(|length| along(length, edge).floor() as usize);
        let stride = [wide + 1, (wide + 1) * (high + 2)];
        let last = [slabs, wide as f64, high as f64].map(|cells| R::of(cells - 1.0));
        CellList {
            // In x cells end where slabs do; elsewhere it does not matter.
            low: [length / 2.0 - span, -span, floor].map(R::of),
            scale: [length, edge, edge].map(|edge| R::of(1.0 / edge)),
            near: R::of(near),
            last,
            stride,
            // With the cells after the last one, and what counting needs.
            start: vec![0; stride[1] * slabs as usize + 4],
            anchored: Vec::new(),
            cells: vec![0; count.next_multiple_of(LANES)],
            sorted: vec![(0, Tag::default()); count],
            places: [(); 3].map(|()| vec![R::of(f64::NAN); count + ABREAST]),
            found: Vec::new(),
            ends: Vec::new(),
        }
    }

    /// Takes in where the blocks are now.
    pub fn sort(&mut self, bodies: &Bodies<R>) {
        self.look_up_cells(bodies);
        let cells = &self.cells[..self.sorted.len()];
        // Two further on are counted: then places are given out one further on, and in the end
        // each number is where it belongs.
        self.start.fill(0);
        for &cell in cells {
            self.start[cell as usize + 2] += 1;
        }
        sum_up(&mut self.start);
        self.anchored.clear();
        if 2 * bodies.count_anchored() > cells.len() {
            self.anchored.resize(self.start.len(), 0);
            for (i, &cell) in (0..).zip(cells) {
                self.anchored[cell as usize + 1] += u32::from(!bodies.is_free(i));
            }
            sum_up(&mut self.anchored);
        }
        let sorted = &mut self.sorted[..cells.len()];
        let [to_x, to_y, to_z] = self
            .places
            .each_mut()
            .map(|places| &mut places[..cells.len()]);
        let groups = bodies.groups().iter().zip(cells.chunks(LANES));
        for (first, (group, cells)) in (0..).step_by(LANES).zip(groups) {
            let [x, y, z] = &group.position;
            for (lane, &cell) in cells.iter().enumerate().take(LANES) {
                let place = &mut self.start[cell as usize + 1];
                let at = *place as usize;
                *place += 1;
                let is_anchored = group.mobility[lane] == R::zero();
                sorted[at] = (cell, Tag::new(first + lane as u32, is_anchored));
                (to_x[at], to_y[at], to_z[at]) = (x[lane], y[lane], z[lane]);
            }
        }
    }

    /// Finds the cell of each block.
    fn look_up_cells(&mut self, bodies: &Bodies<R>) {
        let [row, slab] = self.stride.map(|cells| R::Wide::splat(R::of(cells as f64)));
        let first = R::Wide::splat(R::of(self.cell([0; 3]) as f64));
        let zero = R::Wide::splat(R::zero());
        // So large a number has no fractions.
        let large = R::Wide::splat(R::one() / R::default_epsilon());
        let (low, scale) = (self.low.map(R::Wide::splat), self.scale.map(R::Wide::splat));
        let last = self.last.map(R::Wide::splat);
        let (groups, _) = self.cells.as_chunks_mut::<LANES>();
        for (group, cells) in bodies.groups().iter().zip(groups) {
            let along = |axis: usize, x: &[R; LANES]| {
                let cell = (R::Wide::load(x) - low[axis]) * scale[axis];
                // What is not a number is in the first cell.
                let cell = cell.above(zero).choose(cell, zero);
                cell.minimum(last[axis]) + large - large
            };
            let [x, y, z] = [0, 1, 2].map(|axis| along(axis, &group.position[axis]));
            let all = (x * slab + z * row + y + first).store();
            for (cell, number) in cells.iter_mut().zip(all) {
                *cell = number.round_small();
            }
        }
    }

    /// The number of the cell that a coordinate is in.
    #[inline(always)]
    fn along(&self, axis: usize, x: R) -> usize {
        let cell = (x - self.low[axis]) * self.scale[axis];
        let last = self.last[axis];
        // What is not a number is in the first cell.
        let cell = if cell > R::zero() { cell } else { R::zero() };
        let cell = if cell < last { cell } else { last };
        cell.round_small() as usize
    }

    /// The number of a cell among all.
    #[inline(always)]
    fn cell(&self, [x, y, z]: [usize; 3]) -> usize {
        let [row, slab] = self.stride;
        x * slab + (z + 1) * row + y + 1
    }

    /// Only from so far on in x, blocks of a slab may be near one of the next slab.
    fn edge(&self, slab: usize, slabs: usize) -> R {
        if slab + 1 < slabs {
            R::of(slab as f64 + 0.5) / self.scale[0] + self.low[0] - self.near * R::of(MARGIN)
        } else {
            R::of(f64::INFINITY)
        }
    }

    /// Whether all blocks that are asked for around a cell are known to be anchored.
    fn has_no_free_neighbour(&self, cell: usize) -> bool {
        let [row, slab] = self.stride;
        let next = cell + slab;
        let stretches = [cell + 1, cell + row, next - row, next, next + row];
        let are_anchored = |other: usize| {
            let of = |before: &[u32]| match before.get(other + 2) {
                Some(last) => last - before[other - 1],
                None => 0,
            };
            of(&self.anchored) == of(&self.start)
        };
        !self.anchored.is_empty() && stretches.into_iter().all(are_anchored)
    }

    /// Every pair of blocks that are near each other, but those of which both are anchored; once,
    /// the lower number first, in rising order.
    pub fn close_pairs(&mut self, pairs: &mut Vec<(u32, u32)>) {
        let mut found = std::mem::take(&mut self.found);
        self.find_pairs(&mut found);
        self.in_order(&found, pairs);
        self.found = found;
    }

    /// The same, the lower number first, but in any order and some of them twice.
    fn find_pairs(&self, pairs: &mut Vec<(u32, u32)>) {
        pairs.clear();
        let count = self.sorted.len();
        let [row, slab] = self.stride;
        let slabs = self.start.len() / slab;
        let start = &self.start[..];
        let places = [0, 1, 2].map(|axis| &self.places[axis][..count + ABREAST]);
        let near = R::Quad::splat(self.near * self.near);
        let mut edge = self.edge(0, slabs);
        let mut end = slab;
        for (k, &(cell, own)) in self.sorted.iter().enumerate() {
            let cell = cell as usize;
            if cell >= end {
                edge = self.edge(cell / slab, slabs);
                end = (cell / slab + 1) * slab;
            }
            if own.is_anchored() && self.has_no_free_neighbour(cell) {
                continue;
            }
            let seeker = Seeker {
                here: places.map(|x| R::Quad::splat(x[k])),
                near,
                own,
            };
            let above = &start[cell + row - 1..][..4];
            self.meet(&seeker, [k as u32 + 1, start[cell + 2]], pairs);
            self.meet(&seeker, [above[0], above[3]], pairs);
            if places[0][k] > edge {
                for other in [cell + slab - row, cell + slab, cell + slab + row] {
                    self.meet(&seeker, [start[other - 1], start[other + 2]], pairs);
                }
            }
        }
    }

    /// Sorts pairs, each once: by counting for the first of both, as they are many and each has few others.
    fn in_order(&mut self, found: &[(u32, u32)], pairs: &mut Vec<(u32, u32)>) {
        let ends = &mut self.ends;
        ends.clear();
        ends.resize(self.sorted.len() + 1, 0);
        for &(i, _) in found {
            ends[i as usize + 1] += 1;
        }
        sum_up(ends);
        pairs.clear();
        pairs.resize(found.len(), (0, 0));
        for &(i, j) in found {
            let end = &mut ends[i as usize];
            pairs[*end as usize] = (i, j);
            *end += 1;
        }
        for sorted in 1..pairs.len() {
            let pair = pairs[sorted];
            let mut at = sorted;
            while at > 0 && pairs[at - 1].0 == pair.0 && pairs[at - 1].1 > pair.1 {
                pairs[at] = pairs[at - 1];
                at -= 1;
            }
            pairs[at] = pair;
        }
        pairs.dedup();
    }

    /// Adds the pairs of a block with those near it in a stretch of the sorted list, and maybe with some beyond its end.
    #[inline(always)]
    fn meet(&self, seeker: &Seeker<R>, stretch: [u32; 2], pairs: &mut Vec<(u32, u32)>) {
        let [mut from, to] = stretch.map(|at| at as usize);
        let places = [0, 1, 2].map(|axis| &self.places[axis][..self.sorted.len() + ABREAST]);
        loop {
            let squares = squares(places, &seeker.here, from);
            let hits = seeker.near.above(squares).bits();
            // Whoever is near beyond the end of the stretch is met twice.
            if hits != 0 {
                self.note(seeker.own, from, hits, pairs);
            }
            from += ABREAST;
            if from >= to {
                break;
            }
        }
    }

    /// Adds the pairs of a block with those of a group that are near it. Rare enough for a call.
    #[inline(never)]
    fn note(&self, own: Tag, from: usize, mut hits: u32, pairs: &mut Vec<(u32, u32)>) {
        while hits != 0 {
            let other = self.sorted[from + hits.trailing_zeros() as usize].1;
            hits &= hits - 1;
            if !own.are_anchored(other) {
                let (i, j) = (own.id(), other.id());
                pairs.push((i.min(j), i.max(j)));
            }
        }
    }

    /// The blocks that may be within `reach` of a place, in rising order.
    pub fn around(&self, centre: Vector3<R>, reach: R, found: &mut Vec<u32>) {
        found.clear();
        let range =
            |axis: usize| [centre[axis] - reach, centre[axis] + reach].map(|x| self.along(axis, x));
        let [xs, ys, zs] = [0, 1, 2].map(range);
        for x in xs[0]..=xs[1] {
            for z in zs[0]..=zs[1] {
                let [from, to] =
                    [ys[0], ys[1] + 1].map(|y| self.start[self.cell([x, y, z])] as usize);
                let blocks = (from..to).filter(|&k| {
                    (0..3).all(|axis| (self.places[axis][k] - centre[axis]).abs() <= reach)
                });
                found.extend(blocks.map(|k| self.sorted[k].1.id()));
            }
        }
        found.sort_unstable();
    }
}

/// A block whose neighbours are looked for.
struct Seeker<R: Lane> {
    own: Tag,
    here: [R::Quad; 3],
    /// Closer than this is near, squared.
    near: R::Quad,
}

/// How far a group of blocks is from a place, squared.
#[inline(always)]
fn squares<R: Lane>([x, y, z]: [&[R]; 3], here: &[R::Quad; 3], from: usize) -> R::Quad {
    let square = |places: &[R], here: R::Quad| {
        let group = places[from..from + ABREAST].first_chunk();
        let way = R::Quad::load(group.expect("as many as there are lanes")) - here;
        way * way
    };
    square(x, here[0]) + square(y, here[1]) + square(z, here[2])
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::world::BodyState;
    use stochc_protocol::Orientation;

    /// Against every pair of blocks asked, in grids from a few cells on, some blocks outside of them.
    #[test]
    fn no_pair_is_lost_in_a_grid_of_any_size() {
        let mut dice = ChaCha8Rng::seed_from_u64(1);
        for case in 0..400 {
            let span = [0.5, 2.0, 3.5, 5.0, 9.0, 25.0][case % 6];
            let near = [TOUCH, TOUCH + 1.2][case / 6 % 2];
            let floor = [0.0, -span][case / 12 % 2];
            let wide = 1.3 * span;
            let blocks: Vec<BodyState> = (0..40)
                .map(|_| {
                    let mut along = |low: f64| dice.random_range(low..wide);
                    let place = Vector3::new(along(-wide), along(-wide), along(1.3 * floor));
                    BodyState::at_rest(place)
                })
                .collect();
            let mut bodies: Bodies<f64> = Bodies::new(&blocks, 1.0, 1.0);
            // Few of them, or most.
            let anchored = |i: u32| i.is_multiple_of(4) == (case / 24 % 2 == 0);
            for i in (0..40).filter(|&i| anchored(i)) {
                let place = blocks[i as usize].position;
                bodies.anchor(i, place, Orientation::IDENTITY);
            }
            let top = [span, floor + 0.6][case / 48 % 2];
            let mut grid = CellList::new(blocks.len(), span, [floor, top], near);
            let mut found = Vec::new();
            grid.sort(&bodies);
            grid.close_pairs(&mut found);
            let place = |i: u32| blocks[i as usize].position;
            let pairs = (0..40).flat_map(|i| (i + 1..40).map(move |j| (i, j)));
            let expected: Vec<_> = pairs
                .filter(|&(i, j)| (place(i) - place(j)).norm_squared() < near * near)
                .filter(|&(i, j)| !anchored(i) || !anchored(j))
                .collect();
            assert_eq!(
                found, expected,
                "span {span}, near {near}, {floor} to {top}"
            );
        }
    }
}
