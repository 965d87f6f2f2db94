//! Which blocks are near each other: cells of a grid, one bit each.
//!
//! A dilute suspension leaves nearly all cells empty. One bit per cell is little enough to stay in
//! the cache, and a row of cells is looked at with one shift: a block that is alone costs five.
use super::bodies::Bodies;
use crate::world::real::Real;

/// Farther apart than this \[side\], the centres of two cubes: they do not touch.
pub(super) const TOUCH: f64 = 1.732_050_9;

/// Edge of a cell \[side\], unless there would be too many: a little more than [`TOUCH`].
const EDGE: f64 = 1.74;

/// At most so many cells per block; with more, the cells grow.
const CELLS_PER_BLOCK: f64 = 256.0;

/// At least so many cells are allowed.
const FEW: f64 = 65_536.0;

/// The end of a chain of blocks.
const NONE: u32 = u32::MAX;

/// The blocks by cells.
///
/// Blocks outside of the grid count as inside of its outermost cells, which loses no neighbours.
#[derive(Clone, Debug)]
pub(super) struct Grid<R: Real> {
    /// The middle of the first cell.
    low: [R; 3],
    /// Cells per side.
    scale: R,
    /// Cells along each axis.
    size: [u32; 3],
    /// Words of one row of cells; each row has a cell more at either end, always empty.
    stride: usize,
    /// Whether a cell holds a block, row by row; each layer has an empty row more at either end.
    bits: Vec<u64>,
    /// The last block that hashed here; there are 2^(32 - `shift`).
    head: Vec<u32>,
    shift: u32,
    /// The one before.
    next: Vec<u32>,
    /// The cell of each block.
    cell: Vec<[u32; 3]>,
}

impl<R: Real> Grid<R> {
    /// For blocks that mostly stay within `span` of the origin, and above `floor` \[side\].
    pub fn new(count: usize, span: f64, floor: f64) -> Grid<R> {
        let span = span.max(EDGE);
        let most = (count as f64 * CELLS_PER_BLOCK).max(FEW);
        let mut edge = EDGE;
        let wide = |edge: f64| 2.0 * span / edge + 2.0;
        let high = |edge: f64| (span - floor) / edge + 2.0;
        while wide(edge).powi(2) * high(edge) > most {
            edge *= 1.1;
        }
        let size = [wide(edge), wide(edge), high(edge)].map(|cells| cells as u32);
        let heads = (2 * count).next_power_of_two().max(64);
        let stride = (size[0] as usize + 2).div_ceil(64);
        let rows = (size[1] as usize + 2) * (size[2] as usize + 2);
        Grid {
            low: [-span, -span, floor].map(R::of),
            scale: R::of(1.0 / edge),
            size,
            stride,
            bits: vec![0; rows * stride],
            head: vec![NONE; heads],
            shift: u32::BITS - heads.trailing_zeros(),
            next: vec![NONE; count],
            cell: vec![[0; 3]; count],
        }
    }

    /// Takes in where the blocks are now.
    pub fn sort(&mut self, bodies: &Bodies<R>) {
        self.bits.fill(0);
        self.head.fill(NONE);
        let count = self.cell.len();
        let [x, y, z] = [0, 1, 2].map(|axis| &bodies.position[axis][..count]);
        for i in 0..count {
            self.cell[i] = [
                self.along(0, x[i]),
                self.along(1, y[i]),
                self.along(2, z[i]),
            ];
        }
        for i in 0..count {
            let cell = self.cell[i];
            let row = self.row(cell[1], cell[2]);
            let bit = cell[0] as usize + 1;
            self.bits[row + bit / 64] |= 1 << (bit % 64);
            let slot = self.slot(cell);
            self.next[i] = self.head[slot];
            self.head[slot] = i as u32;
        }
    }

    /// The number of the cell that a coordinate is in.
    #[inline(always)]
    fn along(&self, axis: usize, x: R) -> u32 {
        let cell = (x - self.low[axis]) * self.scale;
        let last = R::of(f64::from(self.size[axis] - 1));
        // What is not a number is in the first cell.
        let cell = if cell > R::zero() { cell } else { R::zero() };
        let cell = if cell < last { cell } else { last };
        cell.round_small()
    }

    /// Where the words of a row begin.
    #[inline(always)]
    fn row(&self, y: u32, z: u32) -> usize {
        ((z as usize + 1) * (self.size[1] as usize + 2) + y as usize + 1) * self.stride
    }

    #[inline(always)]
    fn slot(&self, [x, y, z]: [u32; 3]) -> usize {
        let cell = (z * self.size[1] + y) * self.size[0] + x;
        // Fibonacci hashing: the upper bits are the mixed ones.
        (cell.wrapping_mul(0x9E37_79B9) >> self.shift) as usize
    }

    /// Whether each of three neighbouring cells of a row is occupied, as bits; the middle one is `x`.
    #[inline(always)]
    fn three(&self, row: usize, x: u32) -> u64 {
        let (word, shift) = (row + x as usize / 64, x % 64);
        let low = self.bits[word] >> shift;
        if shift <= 61 {
            low & 7
        } else {
            (low | self.bits[word + 1] << (64 - shift)) & 7
        }
    }

    /// The blocks of a cell, the last first.
    fn blocks_of(&self, cell: [u32; 3]) -> impl Iterator<Item = u32> + '_ {
        let link = |i: u32| (i != NONE).then_some(i);
        let first = link(self.head[self.slot(cell)]);
        std::iter::successors(first, move |&i| link(self.next[i as usize]))
            .filter(move |&i| self.cell[i as usize] == cell)
    }

    /// Every pair of blocks closer than [`TOUCH`], once, in no particular order.
    pub fn close_pairs(&self, bodies: &Bodies<R>, pairs: &mut Vec<(u32, u32)>) {
        pairs.clear();
        let layer = (self.size[1] as usize + 2) * self.stride;
        for i in 0..self.cell.len() {
            let [x, y, z] = self.cell[i];
            let row = self.row(y, z);
            // Half of the 26 cells around: the next one, the row behind, the layer above.
            let next = self.three(row, x) >> 2;
            let behind = self.three(row + self.stride, x);
            let left = self.three(row + layer - self.stride, x);
            let above = self.three(row + layer, x);
            let right = self.three(row + layer + self.stride, x);
            let here = i as u32;
            if self.next[i] != NONE {
                // Those that came earlier into the same cell.
                let mut other = self.next[i];
                while other != NONE {
                    if self.cell[other as usize] == [x, y, z] {
                        meet(bodies, here, other, pairs);
                    }
                    other = self.next[other as usize];
                }
            }
            if next | behind | left | above | right == 0 {
                continue;
            }
            if next != 0 {
                self.meet_all(bodies, here, [x + 1, y, z], pairs);
            }
            let mut row = |mut window: u64, y: u32, z: u32| {
                while window != 0 {
                    let step = window.trailing_zeros();
                    window &= window - 1;
                    self.meet_all(bodies, here, [x + step - 1, y, z], pairs);
                }
            };
            row(behind, y + 1, z);
            row(left, y.wrapping_sub(1), z + 1);
            row(above, y, z + 1);
            row(right, y + 1, z + 1);
        }
    }

    /// Keeps the pairs of block `i` with the blocks of a cell.
    #[inline(always)]
    fn meet_all(&self, bodies: &Bodies<R>, i: u32, cell: [u32; 3], pairs: &mut Vec<(u32, u32)>) {
        let mut other = self.head[self.slot(cell)];
        while other != NONE {
            if self.cell[other as usize] == cell {
                meet(bodies, i, other, pairs);
            }
            other = self.next[other as usize];
        }
    }

    /// The blocks that may be within `reach` of a place, in rising order.
    pub fn around(&self, centre: [R; 3], reach: R, found: &mut Vec<u32>) {
        found.clear();
        let range = |axis: usize| {
            self.along(axis, centre[axis] - reach)..=self.along(axis, centre[axis] + reach)
        };
        for z in range(2) {
            for y in range(1) {
                let row = self.row(y, z);
                for x in range(0) {
                    if self.three(row, x) & 2 != 0 {
                        found.extend(self.blocks_of([x, y, z]));
                    }
                }
            }
        }
        found.sort_unstable();
    }
}

/// Keeps a pair that is close enough to touch.
#[inline(always)]
fn meet<R: Real>(bodies: &Bodies<R>, i: u32, j: u32, pairs: &mut Vec<(u32, u32)>) {
    let way = bodies.centre(i as usize) - bodies.centre(j as usize);
    if way.norm_squared() < R::of(TOUCH * TOUCH) {
        pairs.push((i.min(j), i.max(j)));
    }
}
