//! Slices through the space around a structure, and their maps.
use std::collections::BTreeMap;

use stochc_experiments::resampling::Ratio;
use stochc_ir::Cell;

/// Plane of a slice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slice {
    /// Horizontal plane at a height.
    Horizontal(i32),
    /// Vertical plane from west to east, at a north coordinate.
    Vertical(i32),
}

impl Slice {
    /// Returns the name of the second axis.
    pub fn up(self) -> &'static str {
        match self {
            Slice::Horizontal(_) => "north",
            Slice::Vertical(_) => "up",
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Slice::Horizontal(_) => "horizontal",
            Slice::Vertical(_) => "vertical",
        }
    }

    /// Returns the coordinate of the plane in cells.
    pub fn at(self) -> i32 {
        match self {
            Slice::Horizontal(at) | Slice::Vertical(at) => at,
        }
    }

    /// Returns the coordinates of a cell in the plane. Returns `None` if the cell is outside the
    /// plane.
    pub(super) fn place(self, cell: Cell) -> Option<(i32, i32)> {
        match self {
            Slice::Horizontal(z) => (cell.z == z).then_some((cell.x, cell.y)),
            Slice::Vertical(y) => (cell.y == y).then_some((cell.x, cell.z)),
        }
    }
}

/// A slice through a counted quantity.
#[derive(Clone, Debug)]
pub(crate) struct SliceMap {
    pub slice: Slice,
    /// First and last coordinates of both axes.
    pub ends: ((i32, i32), (i32, i32)),
    /// Estimate for each cell of the map. Absent cells are unknown.
    pub places: BTreeMap<(i32, i32), Ratio>,
    /// Places of the structure in the plane.
    pub structure: Vec<(i32, i32)>,
}

/// The face of a capture, and the rate of blocks that enter its capture range.
#[derive(Clone, Debug)]
pub(crate) struct FaceEntries {
    pub text: String,
    pub cell: Cell,
    /// Entries per tick of waiting.
    pub rate: Ratio,
}

/// Maps of a program.
#[derive(Clone, Debug, Default)]
pub(crate) struct Maps {
    /// Number of recordings used.
    pub runs: usize,
    /// Runs with unusable recordings, with reasons.
    pub left_out: Vec<(u64, String)>,
    /// For each of [`AGES`](super::AGES), the share of the captured blocks per volume of a cell.
    pub before: Vec<[SliceMap; 2]>,
    /// Mean number of free blocks in each cell.
    pub occupation: Option<[SliceMap; 2]>,
    /// Entries per tick of waiting.
    pub entries: Option<[SliceMap; 2]>,
    pub faces: Vec<FaceEntries>,
}
