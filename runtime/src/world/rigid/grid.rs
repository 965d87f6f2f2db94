//! Which blocks are near each other: cells of a grid, one bit each.
//!
//! A dilute suspension leaves nearly all cells empty. One bit per cell is little enough to stay in
//! the cache, and 64 cells of a row are asked at once whether anything is next to them: a block
//! that is alone costs next to nothing.
use super::bodies::Bodies;
use crate::world::real::Real;

/// Farther apart than this \[side\], the centres of two cubes: they do not touch.
pub(super) const TOUCH: f64 = 1.732_050_9;

/// Edge of a cell, in units of the distance that counts as near, unless there would be too many.
const MARGIN: f64 = 1.005;

/// At most so many cells per block; with more, the cells grow.
const CELLS_PER_BLOCK: f64 = 64.0;

/// At least so many cells are allowed.
const FEW: f64 = 65_536.0;

/// The end of a chain of blocks.
const NONE: u32 = u32::MAX;

/// Cells in a word.
const WORD: usize = 64;

/// The blocks by cells.
///
/// Cells are numbered along x, then y, then z, with an empty one between two rows, an empty row
/// between two layers, and an empty layer below and above: a neighbour is a fixed number away.
/// Blocks outside of the grid count as inside of its outermost cells, which loses no neighbours.
#[derive(Clone, Debug)]
pub(super) struct Grid<R: Real> {
    /// The middle of the first cell.
    low: [R; 3],
    /// Cells per side.
    scale: R,
    /// Closer than this is near \[side\].
    near: R,
    /// The last cell along each axis.
    last: [R; 3],
    /// From a cell to the next one behind and above.
    stride: [u32; 2],
    /// To half of the cells around: the next one, the row behind, the layer above.
    around: [u32; HALF],
    /// Whether a cell holds a block.
    occupied: Vec<u64>,
    /// Whether it holds several.
    crowded: Vec<u64>,
    /// Whether it or a neighbour in its row is occupied.
    spread: Vec<u64>,
    /// The last block that came into a cell; says nothing of an empty one.
    head: Vec<u32>,
    /// The one that came before.
    next: Vec<u32>,
}

/// Half of the cells around a cell.
const HALF: usize = 13;

impl<R: Real> Grid<R> {
    /// For blocks that mostly stay within `span` of the origin, and above `floor`, and of which
    /// those closer than `near` are looked for \[side\].
    pub fn new(count: usize, span: f64, floor: f64, near: f64) -> Grid<R> {
        let mut edge = near * MARGIN;
        let span = span.max(edge);
        let most = (count as f64 * CELLS_PER_BLOCK).max(FEW);
        let wide = |edge: f64| 2.0 * span / edge + 2.0;
        let high = |edge: f64| (span - floor) / edge + 2.0;
        while wide(edge).powi(2) * high(edge) > most {
            edge *= 1.1;
        }
        let size = [wide(edge), wide(edge), high(edge)].map(|cells| cells as u32);
        let behind = size[0] + 1;
        let above = behind * (size[1] + 1);
        let triple = |middle: u32| [middle - 1, middle, middle + 1];
        let rows = [behind, above - behind, above, above + behind].map(triple);
        let mut around = [1; HALF];
        around[1..].copy_from_slice(rows.as_flattened());
        let cells = (above * (size[2] + 2)) as usize + 1;
        // Two words more, so that the neighbours of the last cell are in some word.
        let words = cells / WORD + 2;
        Grid {
            low: [-span, -span, floor].map(R::of),
            scale: R::of(1.0 / edge),
            near: R::of(near),
            last: size.map(|cells| R::of(f64::from(cells - 1))),
            stride: [behind, above],
            around,
            occupied: vec![0; words],
            crowded: vec![0; words],
            spread: vec![0; words],
            head: vec![NONE; cells],
            next: vec![NONE; count],
        }
    }

    /// Takes in where the blocks are now.
    pub fn sort(&mut self, bodies: &Bodies<R>) {
        self.occupied.fill(0);
        self.crowded.fill(0);
        let count = self.next.len();
        let [x, y, z] = [0, 1, 2].map(|axis| &bodies.position[axis][..count]);
        for i in 0..count {
            let cell = self.cell([
                self.along(0, x[i]),
                self.along(1, y[i]),
                self.along(2, z[i]),
            ]);
            let (word, mask) = (cell / WORD, 1 << (cell % WORD));
            let head = &mut self.head[cell];
            if self.occupied[word] & mask == 0 {
                self.occupied[word] |= mask;
                self.next[i] = NONE;
            } else {
                self.crowded[word] |= mask;
                self.next[i] = *head;
            }
            *head = i as u32;
        }
    }

    /// The number of the cell that a coordinate is in.
    #[inline(always)]
    fn along(&self, axis: usize, x: R) -> u32 {
        let cell = (x - self.low[axis]) * self.scale;
        let last = self.last[axis];
        // What is not a number is in the first cell.
        let cell = if cell > R::zero() { cell } else { R::zero() };
        let cell = if cell < last { cell } else { last };
        cell.round_small()
    }

    /// The number of a cell among all.
    #[inline(always)]
    fn cell(&self, [x, y, z]: [u32; 3]) -> usize {
        let [behind, above] = self.stride;
        ((z + 1) * above + (y + 1) * behind + x + 1) as usize
    }

    /// The blocks of an occupied cell, the last first.
    fn blocks_of(&self, cell: usize) -> impl Iterator<Item = u32> + '_ {
        std::iter::successors(Some(self.head[cell]), |&i| {
            let next = self.next[i as usize];
            (next != NONE).then_some(next)
        })
    }

    /// Every pair of blocks that are near each other, once, the lower number first, in rising order.
    pub fn close_pairs(&mut self, bodies: &Bodies<R>, pairs: &mut Vec<(u32, u32)>) {
        pairs.clear();
        let (mut before, after) = (0, self.occupied.iter().skip(1).chain(&[0]));
        for ((spread, &here), &after) in self.spread.iter_mut().zip(&self.occupied).zip(after) {
            *spread = here | here << 1 | before >> (WORD - 1) | here >> 1 | after << (WORD - 1);
            before = here;
        }
        let rows = [2, 5, 8, 11].map(|middle| self.around[middle] as usize);
        for (word, &here) in self.occupied.iter().enumerate() {
            if here == 0 {
                continue;
            }
            let first = word * WORD;
            let near = rows
                .iter()
                .fold(bits(&self.occupied, first + 1), |near, row| {
                    near | bits(&self.spread, first + row)
                });
            let mut busy = here & (near | self.crowded[word]);
            while busy != 0 {
                let bit = busy.trailing_zeros() as usize;
                busy &= busy - 1;
                self.meet_around(bodies, first + bit, pairs);
            }
        }
        pairs.sort_unstable();
    }

    /// Keeps the close pairs of a cell's blocks, and theirs with those of half of the cells around.
    #[inline(always)]
    fn meet_around(&self, bodies: &Bodies<R>, cell: usize, pairs: &mut Vec<(u32, u32)>) {
        let mut around = bits(&self.occupied, cell + 1) & 1;
        for row in 0..4 {
            let first = cell + self.around[3 * row + 1] as usize;
            around |= (bits(&self.occupied, first) & 7) << (3 * row + 1);
        }
        let mut i = self.head[cell];
        while i != NONE {
            let next = self.next[i as usize];
            self.meet_chain(bodies, i, next, pairs);
            let mut rest = around;
            while rest != 0 {
                let which = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                let other = cell + self.around[which] as usize;
                self.meet_chain(bodies, i, self.head[other], pairs);
            }
            i = next;
        }
    }

    /// Keeps the close pairs of a block with others of one cell.
    #[inline(always)]
    fn meet_chain(&self, bodies: &Bodies<R>, i: u32, first: u32, pairs: &mut Vec<(u32, u32)>) {
        let mut j = first;
        while j != NONE {
            let way = bodies.centre(i as usize) - bodies.centre(j as usize);
            if way.norm_squared() < self.near * self.near {
                pairs.push((i.min(j), i.max(j)));
            }
            j = self.next[j as usize];
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
                for x in range(0) {
                    let cell = self.cell([x, y, z]);
                    if bits(&self.occupied, cell) & 1 != 0 {
                        found.extend(self.blocks_of(cell));
                    }
                }
            }
        }
        found.sort_unstable();
    }
}

/// 64 bits from any bit on.
#[inline(always)]
fn bits(words: &[u64], first: usize) -> u64 {
    let (word, shift) = (first / WORD, first % WORD);
    // Beyond the end there is nothing, and a word cannot be shifted by all of its bits.
    match words.get(word..word + 2) {
        Some(&[low, high]) => low >> shift | high << 1 << (WORD - 1 - shift),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::world::BodyState;

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
            let bodies: Bodies<f64> = Bodies::new(&blocks, 1.0);
            let mut grid = Grid::new(blocks.len(), span, floor, near);
            let mut found = Vec::new();
            grid.sort(&bodies);
            grid.close_pairs(&bodies, &mut found);
            let place = |i: u32| blocks[i as usize].position;
            let pairs = (0..40).flat_map(|i| (i + 1..40).map(move |j| (i, j)));
            let expected: Vec<_> = pairs
                .filter(|&(i, j)| (place(i) - place(j)).norm_squared() < near * near)
                .collect();
            assert_eq!(found, expected, "span {span}, near {near}, floor {floor}");
        }
    }
}
