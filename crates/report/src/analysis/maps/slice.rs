//! Slices through the space around a structure, as planes of maps.
use std::collections::BTreeMap;

use stochc_experiments::resampling::Ratio;
use stochc_ir::Cell;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slice {
    /// Horizontal plane at a height.
    Horizontal(i32),
    /// Vertical plane from west to east, at a north coordinate.
    Vertical(i32),
}

impl Slice {
    /// Returns the name of the second axis of the plane.
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

    /// Returns the coordinate of the plane along its normal \[cells\].
    pub fn at(self) -> i32 {
        match self {
            Slice::Horizontal(at) | Slice::Vertical(at) => at,
        }
    }

    /// Returns the coordinates of a cell within the plane. Returns `None` if the cell is not in the
    /// plane.
    pub(super) fn place(self, cell: Cell) -> Option<(i32, i32)> {
        match self {
            Slice::Horizontal(z) => (cell.z == z).then_some((cell.x, cell.y)),
            Slice::Vertical(y) => (cell.y == y).then_some((cell.x, cell.z)),
        }
    }
}

/// Map of a quantity in the cells of a slice.
#[derive(Clone, Debug)]
pub(crate) struct SliceMap {
    pub slice: Slice,
    /// First and last coordinate of the map, for both axes.
    pub ends: ((i32, i32), (i32, i32)),
    /// Value of each cell of the map. Cells with unknown values are absent.
    pub places: BTreeMap<(i32, i32), Ratio>,
    /// Coordinates of the structure's cells in the plane.
    pub structure: Vec<(i32, i32)>,
}

/// Face of a capture, and the rate of blocks that enter its capture range.
#[derive(Clone, Debug)]
pub(crate) struct FaceEntries {
    pub text: String,
    pub cell: Cell,
    /// Number of entries per tick of waiting.
    pub rate: Ratio,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Maps {
    /// Number of recordings that the maps use.
    pub runs: usize,
    /// Number of each run whose recording cannot be used, with the reason.
    pub left_out: Vec<(u64, String)>,
    /// Density of the positions of captured blocks, for each of the times [`AGES`](super::AGES)
    /// before the capture. A value is the share of blocks in a cell.
    pub before: Vec<[SliceMap; 2]>,
    /// Mean number of free blocks in each cell. `None` if free blocks were not counted.
    pub occupation: Option<[SliceMap; 2]>,
    /// Number of entries per tick of waiting, for each cell in front of an open face.
    pub entries: Option<[SliceMap; 2]>,
    pub faces: Vec<FaceEntries>,
}
