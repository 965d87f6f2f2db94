//! What is in each cell, where most cells are empty and those that are not are close together.
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};
use stochc_ir::Cell;

/// Cells along each side of a chunk, a power of two: then no division is needed.
const SIDE: i32 = 1 << SIDE_BITS;
const SIDE_BITS: u32 = 2;

/// Cells of a chunk.
const CELLS: usize = SIDE.pow(3) as usize;

/// The place of a chunk among the chunks.
type ChunkKey = [i32; 3];

/// Chunks that a window may have for each cell that it is made for, and besides.
const ROOM: (i64, i64) = (2, 512);

/// A value and a mark for every cell, kept in cubes of cells.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ChunkedGrid<T> {
    window: Window,
    /// Where each chunk outside of the window begins.
    chunks: FxHashMap<ChunkKey, u32>,
    cells: Vec<T>,
    /// The marked cells of each chunk, one bit each.
    marks: Vec<u64>,
    default: T,
}

/// A box of chunks, each of which is found without a search.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Window {
    first: ChunkKey,
    sides: [u32; 3],
    /// Where each chunk begins; [`ABSENT`]: it is not there.
    starts: Vec<u32>,
}

/// Where no chunk begins.
const ABSENT: u32 = u32::MAX;

impl Window {
    /// Around these cells, where they are close together.
    fn around(cells: impl Iterator<Item = Cell>) -> Window {
        let (mut low, mut high, mut count) = ([i32::MAX; 3], [i32::MIN; 3], 0);
        cells.for_each(|cell| {
            let at = [cell.x, cell.y, cell.z];
            low = std::array::from_fn(|axis| low[axis].min(at[axis]));
            high = std::array::from_fn(|axis| high[axis].max(at[axis]));
            count += 1;
        });
        let first = low.map(|at| at.div_euclid(SIDE));
        let last = high.map(|at| at.div_euclid(SIDE));
        let side = |axis: usize| i64::from(last[axis]) - i64::from(first[axis]) + 1;
        let (a_cell, besides) = ROOM;
        let most = count * a_cell + besides;
        let mut chunks = [0, 1, 2].map(side).into_iter();
        let chunks = chunks.try_fold(1i64, |all, side| {
            all.checked_mul(side).filter(|all| (1..=most).contains(all))
        });
        let sides = match chunks {
            Some(_) => [0, 1, 2].map(|axis| side(axis) as u32),
            None => [0; 3],
        };
        Window {
            first,
            sides,
            starts: vec![ABSENT; chunks.unwrap_or(0) as usize],
        }
    }

    /// The number of a chunk in it.
    #[inline]
    fn number(&self, chunk: ChunkKey) -> Option<usize> {
        let [x, y, z] =
            std::array::from_fn(|axis| chunk[axis].wrapping_sub(self.first[axis]) as u32);
        let [width, depth, height] = self.sides;
        (x < width && y < depth && z < height).then(|| ((x * depth + y) * height + z) as usize)
    }
}

impl<T: Copy> ChunkedGrid<T> {
    /// Every cell has the same value. Of these cells it will be asked most often.
    pub fn new(default: T, often: impl Iterator<Item = Cell>) -> ChunkedGrid<T> {
        ChunkedGrid {
            window: Window::around(often),
            chunks: FxHashMap::default(),
            cells: Vec::new(),
            marks: Vec::new(),
            default,
        }
    }

    #[inline]
    pub fn get(&self, cell: Cell) -> T {
        let (chunk, offset) = place(cell);
        match self.find(chunk) {
            Some(start) => self.cells[start as usize + offset],
            None => self.default,
        }
    }

    /// Where a chunk begins.
    #[inline(always)]
    fn find(&self, chunk: ChunkKey) -> Option<u32> {
        match self.window.number(chunk) {
            Some(number) => Some(self.window.starts[number]).filter(|start| *start != ABSENT),
            None => self.find_outside(chunk),
        }
    }

    #[cold]
    fn find_outside(&self, chunk: ChunkKey) -> Option<u32> {
        self.chunks.get(&chunk).copied()
    }

    /// Marks a cell, or takes its mark away: its value.
    #[inline(always)]
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
                    let Some(start) = self.find([x, y, z]) else {
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
    #[inline]
    fn chunk(&mut self, chunk: ChunkKey) -> u32 {
        self.find(chunk).unwrap_or_else(|| self.add(chunk))
    }

    #[cold]
    fn add(&mut self, chunk: ChunkKey) -> u32 {
        let start = self.cells.len() as u32;
        self.cells.resize(self.cells.len() + CELLS, self.default);
        self.marks.push(0);
        match self.window.number(chunk) {
            Some(number) => self.window.starts[number] = start,
            None => {
                self.chunks.insert(chunk, start);
            }
        }
        start
    }

    #[inline(always)]
    pub fn get_mut(&mut self, cell: Cell) -> &mut T {
        let (chunk, offset) = place(cell);
        let start = self.chunk(chunk);
        &mut self.cells[start as usize + offset]
    }
}

/// The chunk of a cell, and the cell's number in it.
#[inline]
fn place(cell: Cell) -> (ChunkKey, usize) {
    let at = [cell.x, cell.y, cell.z];
    let offset = number(at.map(|of| of & (SIDE - 1)));
    (at.map(|of| of >> SIDE_BITS), offset)
}

/// The number of a cell in its chunk, so far from its corner.
fn number([x, y, z]: [i32; 3]) -> usize {
    ((x * SIDE + y) * SIDE + z) as usize
}
