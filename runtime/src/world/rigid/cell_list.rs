//! Neighbour search: blocks sorted by cells of a grid.
//!
//! Cells are long in x and numbered along y first, so that neighbouring cells are adjacent in the
//! sorted list. Half of the cells around a cell form two ranges of the list. Blocks close to the
//! cell's end in x need three more ranges. Ranges are short and are tested four blocks at a time,
//! without branches.
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::bodies::Bodies;
use super::simd::{ABREAST, LANES, Lane, Wide};
use crate::world::blocks::Blocks;

/// Distance of cube centres beyond which they cannot touch \[block lengths\].
pub(super) const TOUCH: f64 = 1.732_050_9;

/// Smallest thickness of a cell, relative to the search distance.
const MARGIN: f64 = 1.005;

/// Largest number of cells per block. Cells grow if there would be more.
const CELLS_PER_BLOCK: f64 = 2.0;

/// Smallest limit on the number of cells.
const FEW: f64 = 1024.0;
/// Largest limit on the number of cells. Cell numbers are also computed as floating-point numbers.
const MANY: f64 = 4_000_000.0;

/// Blocks sorted by cells.
///
/// An empty cell separates two rows, and an empty row lies below and above each slab. Every
/// neighbour is therefore at a fixed offset. Blocks outside the grid count as inside its outermost
/// cells, which loses no neighbours.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
pub(super) struct CellList<R: Lane> {
    /// Centre of the first cell.
    low: [R; 3],
    /// Number of cells per block length, along each axis.
    scale: [R; 3],
    /// Search distance \[block lengths\].
    near: R,
    /// Index of the last cell along each axis.
    last: [R; 3],
    /// Number of cells in a row along y, and in a slab of rows, including the empty ones.
    stride: [usize; 2],
    /// Index of each cell's start in the sorted list, which is also the end of the previous cell.
    start: Vec<u32>,
    /// Number of anchored blocks before each cell. Empty unless most blocks are anchored.
    anchored: Vec<u32>,
    /// Cell of each block by number.
    cells: Vec<u32>,
    /// Cell and tag of each block, sorted by cell and then by number.
    ///
    /// The positions have [`ABREAST`] additional entries that are not blocks.
    sorted: Vec<(u32, Tag)>,
    positions: [Vec<R>; 3],
    /// Buffer for pairs in the order of their discovery.
    #[serde(skip)]
    found: Vec<(u32, u32)>,
    /// Buffer for the index after each block's last pair.
    #[serde(skip)]
    ends: Vec<u32>,
}

/// Tag of a block: number, and whether the block is anchored.
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

/// Replaces counts by cumulative sums.
fn sum_up(counts: &mut [u32]) {
    let mut sum = 0;
    for count in counts {
        sum += *count;
        *count = sum;
    }
}

impl<R: Lane> CellList<R> {
    /// Returns a cell list for blocks that mostly stay within `span` of the origin and between two
    /// heights. `near` is the search distance \[block lengths\].
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
        let last = [slabs, wide as f64, high as f64].map(|cells| R::from_double(cells - 1.0));
        CellList {
            // In x, the grid ends with slabs of cells. Along the other axes, the offset does not
            // matter.
            low: [length / 2.0 - span, -span, floor].map(R::from_double),
            scale: [length, edge, edge].map(|edge| R::from_double(1.0 / edge)),
            near: R::from_double(near),
            last,
            stride,
            // Includes padding after the last cell and space for counting.
            start: vec![0; stride[1] * slabs as usize + 4],
            anchored: Vec::new(),
            cells: vec![0; count.next_multiple_of(LANES)],
            sorted: vec![(0, Tag::default()); count],
            positions: [(); 3].map(|()| vec![R::from_double(f64::NAN); count + ABREAST]),
            found: Vec::new(),
            ends: Vec::new(),
        }
    }

    /// Sorts the blocks by their current positions.
    pub fn sort(&mut self, bodies: &Bodies<R>) {
        self.look_up_cells(bodies);
        let cells = &self.cells[..self.sorted.len()];
        // Counts are stored two entries further, and positions are assigned one entry further. At
        // the end, each entry is at its own index.
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
            .positions
            .each_mut()
            .map(|positions| &mut positions[..cells.len()]);
        let groups = bodies.groups().iter().zip(cells.chunks(LANES));
        for (first, (group, cells)) in (0..).step_by(LANES).zip(groups) {
            let [x, y, z] = &group.position;
            for (lane, &cell) in cells.iter().enumerate().take(LANES) {
                let end = &mut self.start[cell as usize + 1];
                let at = *end as usize;
                *end += 1;
                let is_anchored = group.mobility[lane] == R::zero();
                sorted[at] = (cell, Tag::new(first + lane as u32, is_anchored));
                (to_x[at], to_y[at], to_z[at]) = (x[lane], y[lane], z[lane]);
            }
        }
    }

    fn look_up_cells(&mut self, bodies: &Bodies<R>) {
        let [row, slab] = self
            .stride
            .map(|cells| R::Wide::splat(R::from_double(cells as f64)));
        let first = R::Wide::splat(R::from_double(self.cell([0; 3]) as f64));
        let zero = R::Wide::splat(R::zero());
        // Adding such a large number rounds to an integer.
        let large = R::Wide::splat(R::one() / R::default_epsilon());
        let (low, scale) = (self.low.map(R::Wide::splat), self.scale.map(R::Wide::splat));
        let last = self.last.map(R::Wide::splat);
        let (groups, _) = self.cells.as_chunks_mut::<LANES>();
        for (group, cells) in bodies.groups().iter().zip(groups) {
            let along = |axis: usize, x: &[R; LANES]| {
                let cell = (R::Wide::load(x) - low[axis]) * scale[axis];
                // NaN maps to the first cell.
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

    /// Returns the index of the cell at a coordinate.
    #[inline(always)]
    fn along(&self, axis: usize, x: R) -> usize {
        let cell = (x - self.low[axis]) * self.scale[axis];
        let last = self.last[axis];
        // NaN maps to the first cell.
        let cell = if cell > R::zero() { cell } else { R::zero() };
        let cell = if cell < last { cell } else { last };
        cell.round_small() as usize
    }

    #[inline(always)]
    fn cell(&self, [x, y, z]: [usize; 3]) -> usize {
        let [row, slab] = self.stride;
        x * slab + (z + 1) * row + y + 1
    }

    /// Returns the x coordinate beyond which blocks of a slab may be near blocks of the next slab.
    fn edge(&self, slab: usize, slabs: usize) -> R {
        if slab + 1 < slabs {
            R::from_double(slab as f64 + 0.5) / self.scale[0] + self.low[0]
                - self.near * R::from_double(MARGIN)
        } else {
            R::from_double(f64::INFINITY)
        }
    }

    /// Returns whether all blocks in and around a cell are anchored.
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

    /// Lists every pair of nearby blocks with at least one free block. Pairs are unique and in
    /// ascending order, the lower number first.
    pub fn close_pairs(&mut self, pairs: &mut Vec<(u32, u32)>) {
        let mut found = std::mem::take(&mut self.found);
        self.find_pairs(&mut found);
        self.in_order(&found, pairs);
        self.found = found;
    }

    /// Finds the pairs in any order, some of them twice, the lower number first.
    fn find_pairs(&self, pairs: &mut Vec<(u32, u32)>) {
        pairs.clear();
        let count = self.sorted.len();
        let [row, slab] = self.stride;
        let slabs = self.start.len() / slab;
        let start = &self.start[..];
        let positions = [0, 1, 2].map(|axis| &self.positions[axis][..count + ABREAST]);
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
                here: positions.map(|x| R::Quad::splat(x[k])),
                near,
                own,
            };
            let above = &start[cell + row - 1..][..4];
            self.meet(&seeker, [k as u32 + 1, start[cell + 2]], pairs);
            self.meet(&seeker, [above[0], above[3]], pairs);
            if positions[0][k] > edge {
                for other in [cell + slab - row, cell + slab, cell + slab + row] {
                    self.meet(&seeker, [start[other - 1], start[other + 2]], pairs);
                }
            }
        }
    }

    /// Sorts and deduplicates pairs. Uses a counting sort by the first block, because there are
    /// many blocks with few pairs each.
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

    /// Adds the pairs of the block `seeker` with the blocks in the range `stretch` of the sorted
    /// list. May also add pairs with a few blocks after the range.
    #[inline(always)]
    fn meet(&self, seeker: &Seeker<R>, stretch: [u32; 2], pairs: &mut Vec<(u32, u32)>) {
        let [mut from, to] = stretch.map(|at| at as usize);
        let positions = [0, 1, 2].map(|axis| &self.positions[axis][..self.sorted.len() + ABREAST]);
        loop {
            let squares = squares(positions, &seeker.here, from);
            let hits = seeker.near.above(squares).bits();
            // Blocks beyond the end of the range may be found twice.
            if hits != 0 {
                self.note(seeker.own, from, hits, pairs);
            }
            from += ABREAST;
            if from >= to {
                break;
            }
        }
    }

    /// Adds pairs of a block with other blocks. `hits` marks these blocks in a SIMD vector. Rarely
    /// called, so it is not inlined.
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

    /// Lists the blocks that may be within `reach` of a position, in ascending order.
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
                    (0..3).all(|axis| (self.positions[axis][k] - centre[axis]).abs() <= reach)
                });
                found.extend(blocks.map(|k| self.sorted[k].1.id()));
            }
        }
        found.sort_unstable();
    }
}

/// Block whose neighbours are being searched.
struct Seeker<R: Lane> {
    own: Tag,
    here: [R::Quad; 3],
    /// Square of the search distance.
    near: R::Quad,
}

/// Returns the squared distances of [`ABREAST`] successive blocks from a position.
#[inline(always)]
fn squares<R: Lane>([x, y, z]: [&[R]; 3], here: &[R::Quad; 3], from: usize) -> R::Quad {
    let square = |positions: &[R], here: R::Quad| {
        let group = positions[from..from + ABREAST].first_chunk();
        let difference = R::Quad::load(group.expect("positions are padded to a full lane")) - here;
        difference * difference
    };
    square(x, here[0]) + square(y, here[1]) + square(z, here[2])
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::world::BodyState;
    use stochc_control::Orientation;

    /// Compares the pairs with the result of testing all pairs, in grids of various sizes. Some
    /// blocks are outside of the grid.
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
                    let position = Vector3::new(along(-wide), along(-wide), along(1.3 * floor));
                    BodyState::at_rest(position)
                })
                .collect();
            let mut bodies: Bodies<f64> = Bodies::new(&blocks, 1.0, 1.0);
            // A quarter or three quarters of the blocks are anchored.
            let anchored = |i: u32| i.is_multiple_of(4) == (case / 24 % 2 == 0);
            for i in (0..40).filter(|&i| anchored(i)) {
                let position = blocks[i as usize].position;
                bodies.anchor(i, position, Orientation::IDENTITY);
            }
            let top = [span, floor + 0.6][case / 48 % 2];
            let mut grid = CellList::new(blocks.len(), span, [floor, top], near);
            let mut found = Vec::new();
            grid.sort(&bodies);
            grid.close_pairs(&mut found);
            let position = |i: u32| blocks[i as usize].position;
            let pairs = (0..40).flat_map(|i| (i + 1..40).map(move |j| (i, j)));
            let expected: Vec<_> = pairs
                .filter(|&(i, j)| (position(i) - position(j)).norm_squared() < near * near)
                .filter(|&(i, j)| !anchored(i) || !anchored(j))
                .collect();
            assert_eq!(
                found, expected,
                "span {span}, near {near}, {floor} to {top}"
            );
        }
    }
}
