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

    /// Shows the cells that are at most so many steps away along each axis, by their offsets, but for those of which nothing has been said.
    pub fn each_near(&self, centre: Cell, steps: i32, mut show: impl FnMut([i32; 3], T)) {
        let centre = [centre.x, centre.y, centre.z];
        let low = centre.map(|at| at.saturating_sub(steps));
        let high = centre.map(|at| at.saturating_add(steps));
        let chunks = |axis: usize| low[axis].div_euclid(SIDE)..=high[axis].div_euclid(SIDE);
        for x in chunks(0) {
            for y in chunks(1) {
                for z in chunks(2) {
                    let chunk = [x, y, z];
                    let Some(&start) = self.chunks.get(&chunk) else {
                        continue;
                    };
                    // The cells of the chunk that are near, from its corner.
                    let [xs, ys, zs] = [0, 1, 2].map(|axis| {
                        let corner = chunk[axis] * SIDE;
                        (low[axis].max(corner) - corner)
                            ..=(high[axis].min(corner + SIDE - 1) - corner)
                    });
                    for i in xs {
                        for j in ys.clone() {
                            for k in zs.clone() {
                                let inside = [i, j, k];
                                let offset = [0, 1, 2]
                                    .map(|axis| chunk[axis] * SIDE + inside[axis] - centre[axis]);
                                show(offset, self.cells[start as usize + number(inside)]);
                            }
                        }
                    }
                }
            }
        }
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
    (at.map(|of| of.div_euclid(SIDE)), number([x, y, z]))
}

/// The number of a cell in its chunk, so far from its corner.
fn number([x, y, z]: [i32; 3]) -> usize {
    ((x * SIDE + y) * SIDE + z) as usize
}
