//! What is in each cell, where most cells are empty and those that are not are close together.
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};
use stochc_ir::Cell;

/// Cells along each side of a chunk.
const SIDE: i32 = 4;

/// Cells of a chunk.
const CELLS: usize = SIDE.pow(3) as usize;

/// The place of a chunk among the chunks: x and y, z. Two numbers are hashed faster than three.
type ChunkKey = (u64, i32);

/// A value and a mark for every cell, kept in cubes of cells.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ChunkedGrid<T> {
    /// Where each chunk begins.
    chunks: FxHashMap<ChunkKey, u32>,
    cells: Vec<T>,
    /// The marked cells of each chunk, one bit each.
    marks: Vec<u64>,
    default: T,
}

impl<T: Copy> ChunkedGrid<T> {
    /// Every cell has the same value.
    pub fn new(default: T) -> ChunkedGrid<T> {
        ChunkedGrid {
            chunks: FxHashMap::default(),
            cells: Vec::new(),
            marks: Vec::new(),
            default,
        }
    }

    pub fn get(&self, cell: Cell) -> T {
        let (chunk, offset) = place(cell);
        let start = self.chunks.get(&chunk);
        start.map_or(self.default, |start| self.cells[*start as usize + offset])
    }

    /// Marks a cell, or takes its mark away: its value.
    pub fn mark(&mut self, cell: Cell, is_marked: bool) -> &mut T {
        let (chunk, offset) = place(cell);
        let start = self.chunk(chunk);
        let marks = &mut self.marks[start as usize / CELLS];
        match is_marked {
            true => *marks |= 1 << offset,
            false => *marks &= !(1 << offset),
        }
        &mut self.cells[start as usize + offset]
    }

    /// Shows the marked cells that are at most so many steps away along each axis, by their offsets.
    pub fn each_marked_near(&self, centre: Cell, steps: i32, mut show: impl FnMut([i32; 3])) {
        let centre = [centre.x, centre.y, centre.z];
        let low = centre.map(|at| at.saturating_sub(steps));
        let high = centre.map(|at| at.saturating_add(steps));
        let chunks = |axis: usize| low[axis].div_euclid(SIDE)..=high[axis].div_euclid(SIDE);
        for x in chunks(0) {
            for y in chunks(1) {
                for z in chunks(2) {
                    let Some(&start) = self.chunks.get(&key([x, y, z])) else {
                        continue;
                    };
                    let mut marks = self.marks[start as usize / CELLS];
                    while marks != 0 {
                        let number = marks.trailing_zeros() as i32;
                        marks &= marks - 1;
                        let cell = [
                            x * SIDE + number / (SIDE * SIDE),
                            y * SIDE + number / SIDE % SIDE,
                            z * SIDE + number % SIDE,
                        ];
                        if (0..3).all(|axis| (low[axis]..=high[axis]).contains(&cell[axis])) {
                            show([0, 1, 2].map(|axis| cell[axis] - centre[axis]));
                        }
                    }
                }
            }
        }
    }

    /// Where a chunk begins, which is there from now on.
    fn chunk(&mut self, chunk: ChunkKey) -> u32 {
        *self.chunks.entry(chunk).or_insert_with(|| {
            let start = self.cells.len();
            self.cells.resize(start + CELLS, self.default);
            self.marks.push(0);
            start as u32
        })
    }

    pub fn get_mut(&mut self, cell: Cell) -> &mut T {
        let (chunk, offset) = place(cell);
        let start = self.chunk(chunk);
        &mut self.cells[start as usize + offset]
    }
}

/// The chunk of a cell, and the cell's number in it.
fn place(cell: Cell) -> (ChunkKey, usize) {
    let at = [cell.x, cell.y, cell.z];
    let [x, y, z] = at.map(|of| of.rem_euclid(SIDE));
    (key(at.map(|of| of.div_euclid(SIDE))), number([x, y, z]))
}

fn key([x, y, z]: [i32; 3]) -> ChunkKey {
    (u64::from(x as u32) << 32 | u64::from(y as u32), z)
}

/// The number of a cell in its chunk, so far from its corner.
fn number([x, y, z]: [i32; 3]) -> usize {
    ((x * SIDE + y) * SIDE + z) as usize
}
