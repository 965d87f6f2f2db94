//! Sparse grid of cells, for occupied cells that are close together.
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};
use stochc_ir::Cell;

/// Number of cells along each edge of a chunk. A power of two, which avoids divisions.
const SIDE: i32 = 1 << SIDE_BITS;
const SIDE_BITS: u32 = 2;

/// Number of cells in a chunk.
const CELLS: usize = SIDE.pow(3) as usize;

/// Position of a chunk in the grid of chunks.
type ChunkKey = [i32; 3];

/// Size limit of a window \[chunks\]. The first number applies per requested cell or existing
/// chunk. The second number is added.
const ROOM: (i64, i64) = (4, 512);

/// Bit masks of the cells of a chunk between two coordinates along an axis. The indices are the
/// axis, the first coordinate and the last coordinate.
const SLABS: [[[u64; SIDE as usize]; SIDE as usize]; 3] = {
    // Marks at coordinate 0, and the shift to the next coordinate.
    let axes = [
        (0x0000_0000_0000_ffff, 16),
        (0x000f_000f_000f_000f, 4),
        (0x1111_1111_1111_1111_u64, 1),
    ];
    let mut slabs = [[[0; SIDE as usize]; SIDE as usize]; 3];
    let mut axis = 0;
    while axis < 3 {
        let (slab, stride) = axes[axis];
        let mut low = 0;
        while low < SIDE as usize {
            let mut marks = 0;
            let mut high = low;
            while high < SIDE as usize {
                marks |= slab << (stride * high);
                slabs[axis][low][high] = marks;
                high += 1;
            }
            low += 1;
        }
        axis += 1;
    }
    slabs
};

/// Grid with a value and a mark for every cell, stored in chunks.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct ChunkedGrid<T> {
    window: Window,
    /// Chunks outside the window.
    chunks: FxHashMap<ChunkKey, CellChunk>,
    cells: Vec<T>,
    default: T,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct CellChunk {
    /// Index of the chunk's first cell, or [`ABSENT`].
    start: u32,
    /// Marked cells, one bit each.
    marks: u64,
}

/// Box of chunks that are found by index, without a search.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Window {
    first: ChunkKey,
    sides: [u32; 3],
    chunks: Vec<CellChunk>,
}

/// Index of absent chunks.
const ABSENT: u32 = u32::MAX;

const NO_CHUNK: CellChunk = CellChunk {
    start: ABSENT,
    marks: 0,
};

impl Window {
    /// Returns a window around these cells if they are close together.
    fn around(cells: impl Iterator<Item = Cell>) -> Window {
        let (mut low, mut high, mut count) = ([i32::MAX; 3], [i32::MIN; 3], 0);
        for cell in cells {
            let at = [cell.x, cell.y, cell.z];
            low = std::array::from_fn(|axis| low[axis].min(at[axis]));
            high = std::array::from_fn(|axis| high[axis].max(at[axis]));
            count += 1;
        }
        let ends = [low, high].map(|end| end.map(|at| at.div_euclid(SIDE)));
        Window::between(ends, count).unwrap_or(Window {
            first: [0; 3],
            sides: [0; 3],
            chunks: Vec::new(),
        })
    }

    /// Returns a window from one chunk to another, unless it would be too large for this number of
    /// cells.
    fn between([first, last]: [ChunkKey; 2], cells: i64) -> Option<Window> {
        let side = |axis: usize| i64::from(last[axis]) - i64::from(first[axis]) + 1;
        let (a_cell, besides) = ROOM;
        let most = cells * a_cell + besides;
        let chunks = [0, 1, 2]
            .map(side)
            .into_iter()
            .try_fold(1i64, |all, side| {
                all.checked_mul(side).filter(|all| (1..=most).contains(all))
            })?;
        Some(Window {
            first,
            sides: [0, 1, 2].map(|axis| side(axis) as u32),
            chunks: vec![NO_CHUNK; chunks as usize],
        })
    }

    /// Returns the window, extended to a chunk outside of it and by at least half its size. Returns
    /// `None` if the size limit does not allow it.
    fn towards(&self, chunk: ChunkKey, chunks: i64) -> Option<Window> {
        if self.chunks.is_empty() {
            return Window::between([chunk; 2], chunks);
        }
        let ends = [0, 1, 2].map(|axis| {
            let (first, side) = (self.first[axis], self.sides[axis] as i32);
            let more = side / 2;
            let (at, last) = (chunk[axis], first + (side - 1));
            let low = if at < first {
                at.min(first.saturating_sub(more))
            } else {
                first
            };
            let high = if at > last {
                at.max(last.saturating_add(more))
            } else {
                last
            };
            [low, high]
        });
        Window::between([0, 1].map(|end| ends.map(|axis| axis[end])), chunks)
    }

    /// Returns the index of a chunk in the window.
    #[inline]
    fn number(&self, chunk: ChunkKey) -> Option<usize> {
        let [x, y, z] =
            std::array::from_fn(|axis| chunk[axis].wrapping_sub(self.first[axis]) as u32);
        let [width, depth, height] = self.sides;
        (x < width && y < depth && z < height).then(|| ((x * depth + y) * height + z) as usize)
    }

    /// Returns the difference in index between two chunks at this distance along each axis.
    #[inline]
    fn stride(&self, [x, y, z]: [usize; 3]) -> usize {
        let [_, depth, height] = self.sides.map(|side| side as usize);
        (x * depth + y) * height + z
    }

    fn keys(&self) -> impl Iterator<Item = ChunkKey> {
        let [width, depth, height] = self.sides;
        let [x, y, z] = self.first;
        (0..width * depth * height).map(move |number| {
            let (column, above) = (number / height, number % height);
            let steps = [column / depth, column % depth, above];
            [0, 1, 2].map(|axis| [x, y, z][axis] + steps[axis] as i32)
        })
    }
}

impl<T: Copy> ChunkedGrid<T> {
    /// Returns a grid with the same value everywhere. `often` are the cells that are accessed most.
    pub fn new(default: T, often: impl Iterator<Item = Cell>) -> ChunkedGrid<T> {
        ChunkedGrid {
            window: Window::around(often),
            chunks: FxHashMap::default(),
            cells: Vec::new(),
            default,
        }
    }

    #[inline]
    pub fn get(&self, cell: Cell) -> T {
        let (key, offset) = chunk_and_offset(cell);
        match self.find(key).start {
            ABSENT => self.default,
            start => self.cells[start as usize + offset],
        }
    }

    #[inline(always)]
    fn find(&self, key: ChunkKey) -> CellChunk {
        match self.window.number(key) {
            Some(number) => self.window.chunks[number],
            None => self.find_outside(key),
        }
    }

    #[cold]
    fn find_outside(&self, key: ChunkKey) -> CellChunk {
        self.chunks.get(&key).copied().unwrap_or(NO_CHUNK)
    }

    /// Sets or clears the mark of a cell and returns its value.
    #[inline(always)]
    pub fn mark(&mut self, cell: Cell, is_marked: bool) -> &mut T {
        let (key, offset) = chunk_and_offset(cell);
        let chunk = self.chunk(key);
        if is_marked {
            chunk.marks |= 1 << offset
        } else {
            chunk.marks &= !(1 << offset)
        }
        let start = chunk.start as usize;
        &mut self.cells[start + offset]
    }

    /// Calls `show` with the offset and value of each marked cell at most `steps` away along each
    /// axis. `steps` must be less than the edge of a chunk.
    #[inline]
    pub fn each_marked_near(&self, centre: Cell, steps: i32, mut show: impl FnMut([i32; 3], T)) {
        let centre = [centre.x, centre.y, centre.z];
        let low = centre.map(|at| at.saturating_sub(steps));
        let high = centre.map(|at| at.saturating_add(steps));
        let first = low.map(|at| at.div_euclid(SIDE));
        let last = high.map(|at| at.div_euclid(SIDE));
        // Bit masks of the cells to search along an axis, in its first and its second chunk.
        let slabs = |axis: usize| {
            let (low, high) = (low[axis].rem_euclid(SIDE), high[axis].rem_euclid(SIDE));
            let (low, high) = (low as usize, high as usize);
            if first[axis] == last[axis] {
                [SLABS[axis][low][high], 0]
            } else {
                [SLABS[axis][low][SIDE as usize - 1], SLABS[axis][0][high]]
            }
        };
        let slabs = [0, 1, 2].map(slabs);
        let mut show_in = |key: ChunkKey, start: u32, mut marks: u64| {
            while marks != 0 {
                let number = marks.trailing_zeros() as i32;
                marks &= marks - 1;
                let within = [number / (SIDE * SIDE), number / SIDE % SIDE, number % SIDE];
                let offset = [0, 1, 2].map(|axis| key[axis] * SIDE + within[axis] - centre[axis]);
                show(offset, self.cells[start as usize + number as usize]);
            }
        };
        let window = &self.window;
        let all_in_window = window.number(last).is_some();
        let in_window = window.number(first).filter(|_| all_in_window);
        let above = (last[2] - first[2]) as usize;
        for (x, of_x) in (first[0]..).zip(slabs[0]) {
            for (y, of_y) in (first[1]..).zip(slabs[1]) {
                let slab = of_x & of_y;
                if slab == 0 {
                    continue;
                }
                if let Some(number) = in_window {
                    let steps = [x - first[0], y - first[1], 0];
                    let number = number + window.stride(steps.map(|step| step as usize));
                    let column = &window.chunks[number..=number + above];
                    for ((z, of_z), chunk) in (first[2]..).zip(slabs[2]).zip(column) {
                        let marks = chunk.marks & slab & of_z;
                        if marks != 0 {
                            show_in([x, y, z], chunk.start, marks);
                        }
                    }
                } else {
                    for (z, of_z) in (first[2]..=last[2]).zip(slabs[2]) {
                        let chunk = self.find([x, y, z]);
                        show_in([x, y, z], chunk.start, chunk.marks & slab & of_z);
                    }
                }
            }
        }
    }

    /// Returns the chunk at a position and adds it if it is absent.
    #[inline]
    fn chunk(&mut self, key: ChunkKey) -> &mut CellChunk {
        match self.window.number(key) {
            Some(number) if self.window.chunks[number].start != ABSENT => {
                &mut self.window.chunks[number]
            }
            _ => self.chunk_to_add(key),
        }
    }

    /// Returns the chunk at a position. Slow path of `chunk`, which adds absent chunks and looks
    /// outside of the window.
    #[cold]
    fn chunk_to_add(&mut self, key: ChunkKey) -> &mut CellChunk {
        if self.find(key).start == ABSENT {
            self.add(key);
        }
        match self.window.number(key) {
            Some(number) => &mut self.window.chunks[number],
            None => self.chunks.entry(key).or_insert(NO_CHUNK),
        }
    }

    #[cold]
    fn add(&mut self, key: ChunkKey) {
        let start = self.cells.len() as u32;
        self.cells.resize(self.cells.len() + CELLS, self.default);
        let chunk = CellChunk { start, marks: 0 };
        if self.window.number(key).is_none() {
            self.widen(key);
        }
        match self.window.number(key) {
            Some(number) => self.window.chunks[number] = chunk,
            None => {
                self.chunks.insert(key, chunk);
            }
        }
    }

    /// Extends the window towards a chunk if the size limit allows it.
    fn widen(&mut self, key: ChunkKey) {
        let count = self.cells.len() / CELLS;
        let Some(mut wider) = self.window.towards(key, count as i64) else {
            return;
        };
        let inside = self.window.keys().zip(self.window.chunks.iter().copied());
        let mut outside = FxHashMap::default();
        for (key, chunk) in inside.chain(self.chunks.drain()) {
            match wider.number(key) {
                Some(number) => wider.chunks[number] = chunk,
                None => {
                    outside.insert(key, chunk);
                }
            }
        }
        (self.window, self.chunks) = (wider, outside);
    }

    #[inline(always)]
    pub fn get_mut(&mut self, cell: Cell) -> &mut T {
        let (key, offset) = chunk_and_offset(cell);
        let start = self.chunk(key).start as usize;
        &mut self.cells[start + offset]
    }
}

/// Returns the chunk of a cell, and the cell's index in it.
#[inline]
fn chunk_and_offset(cell: Cell) -> (ChunkKey, usize) {
    let at = [cell.x, cell.y, cell.z];
    let offset = number(at.map(|of| of & (SIDE - 1)));
    (at.map(|of| of >> SIDE_BITS), offset)
}

/// Returns the index of a cell at an offset from the corner of its chunk.
fn number([x, y, z]: [i32; 3]) -> usize {
    ((x * SIDE + y) * SIDE + z) as usize
}
