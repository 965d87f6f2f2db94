use serde::{Deserialize, Serialize};

use crate::Face;

/// Site of the structure's cubic lattice, in block lengths: x east, y north, z up.
///
/// The seed plate is the layer z = 0 with its south-west block at (0, 0, 0). Its upper faces are
/// level with the ground, so captured blocks have z >= 1.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize,
)]
#[serde(from = "[i32; 3]", into = "[i32; 3]")]
pub struct Cell {
    /// Block lengths east of the plate's south-west block.
    pub x: i32,
    /// Block lengths north of the plate's south-west block.
    pub y: i32,
    /// Layers above the plate.
    pub z: i32,
}

impl Cell {
    /// Returns the cell at (x, y, z).
    pub const fn new(x: i32, y: i32, z: i32) -> Cell {
        Cell { x, y, z }
    }

    /// Returns the cell across `face`, or `None` if a coordinate would overflow.
    #[inline]
    pub fn across(self, face: Face) -> Option<Cell> {
        self.offset(face.normal())
    }

    /// Returns the cell at an offset, or `None` if a coordinate would overflow.
    #[inline]
    pub fn offset(self, [dx, dy, dz]: [i32; 3]) -> Option<Cell> {
        Some(Cell {
            x: self.x.checked_add(dx)?,
            y: self.y.checked_add(dy)?,
            z: self.z.checked_add(dz)?,
        })
    }
}

/// Returns the offsets of all cells within `reach` along each axis, including (0, 0, 0).
pub fn offsets_within(reach: i32) -> impl Iterator<Item = [i32; 3]> {
    let along = move || -reach..=reach;
    along().flat_map(move |x| along().flat_map(move |y| along().map(move |z| [x, y, z])))
}

impl From<[i32; 3]> for Cell {
    fn from([x, y, z]: [i32; 3]) -> Cell {
        Cell { x, y, z }
    }
}

impl From<Cell> for [i32; 3] {
    fn from(cell: Cell) -> [i32; 3] {
        [cell.x, cell.y, cell.z]
    }
}

impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "({}, {}, {})", self.x, self.y, self.z)
    }
}
