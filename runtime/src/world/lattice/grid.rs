//! What is in each cell, where most cells are empty and those that are not are close together.
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};
use stochc_ir::Cell;

/// Cells along each side of a chunk.
const SIDE: i32 = 4;

/// A value for every cell, kept in cubes of cells.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ChunkedGrid<T> {
    /// Where the chunk of a corner begins.
    chunks: FxHashMap<[i32; 3], u32>,
    cells: Vec<T>,
    default: T,
}

impl<T: Copy> ChunkedGrid<T> {
    /// Every cell has the same value.
    pub fn new(default: T) -> ChunkedGrid<T> {
        ChunkedGrid {
            chunks: FxHashMap::default(),
            cells: Vec::new(),
            default,
        }
    }

    pub fn get(&self, cell: Cell) -> T {
        let (chunk, offset) = place(cell);
        let start = self.chunks.get(&chunk);
        start.map_or(self.default, |start| self.cells[*start as usize + offset])
    }

    pub fn get_mut(&mut self, cell: Cell) -> &mut T {
        let (chunk, offset) = place(cell);
        let start = *self.chunks.entry(chunk).or_insert_with(|| {
            let start = self.cells.len();
            self.cells
                .resize(start + SIDE.pow(3) as usize, self.default);
            start as u32
        });
        &mut self.cells[start as usize + offset]
    }
}

/// The chunk of a cell, and the cell's number in it.
fn place(cell: Cell) -> ([i32; 3], usize) {
    let at = [cell.x, cell.y, cell.z];
    let [x, y, z] = at.map(|of| of.rem_euclid(SIDE));
    (
        at.map(|of| of.div_euclid(SIDE)),
        ((x * SIDE + y) * SIDE + z) as usize,
    )
}
