//! Scaffolds: masts with the segments that they hold.
use stochc_ir::{Cell, Face};

/// Masts and the segments on them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scaffolding {
    /// Segments in order of addition.
    pub segments: Vec<MastSegment>,
    /// Guide masts, which need not hold segments, with their heights. They guide free blocks to
    /// adjacent growth.
    pub guides: Vec<((i32, i32), i32)>,
}

/// Path of target cells. Its blocks grow from a mast, and are handed over later.
#[derive(Clone, Debug, PartialEq)]
pub struct MastSegment {
    /// Position of the mast on the plate.
    pub foot: (i32, i32),
    /// Layer of the mast's block that captures the first cell.
    pub height: i32,
    /// Direction from the mast's block to the first cell.
    pub direction: Face,
    /// Cells of the segment, from the mast outwards.
    pub cells: Vec<Cell>,
    /// Final parent of the last cell, a cell of the target.
    pub join: Cell,
}

impl Scaffolding {
    /// Returns the masts with their positions on the plate and heights.
    pub fn masts(&self) -> Vec<((i32, i32), i32)> {
        let mut masts: Vec<((i32, i32), i32)> = Vec::new();
        let holding = self
            .segments
            .iter()
            .map(|segment| (segment.foot, segment.height));
        for (foot, height) in holding.chain(self.guides.iter().copied()) {
            match masts.iter_mut().find(|(known, _)| *known == foot) {
                Some((_, highest)) => *highest = height.max(*highest),
                None => masts.push((foot, height)),
            }
        }
        masts
    }

    /// Returns whether there is no mast.
    pub fn is_empty(&self) -> bool {
        self.segments.is_empty() && self.guides.is_empty()
    }

    /// Returns the cells of all masts, each mast from bottom to top.
    pub fn cells(&self) -> impl Iterator<Item = Cell> {
        let masts = self.masts().into_iter();
        masts.flat_map(|((x, y), height)| (1..=height).map(move |z| Cell::new(x, y, z)))
    }
}

impl MastSegment {
    /// Returns the cells from the mast outwards, each with the direction from the previous cell.
    pub fn grown(&self) -> impl Iterator<Item = (Cell, Face)> {
        let steps = self.cells.windows(2).map(|two| direction(two[0], two[1]));
        (self.cells.iter().copied()).zip(std::iter::once(self.direction).chain(steps))
    }

    /// Returns the cells in hand-over order. Each has the direction from its final parent.
    pub fn handed_over(&self) -> impl Iterator<Item = (Cell, Face)> {
        let holders = std::iter::once(self.join).chain(self.cells.iter().rev().copied());
        let cells = self.cells.iter().rev().copied();
        cells
            .zip(holders)
            .map(|(cell, holder)| (cell, direction(holder, cell)))
    }
}

/// Returns the face of a cell towards an adjacent one.
pub(super) fn direction(from: Cell, to: Cell) -> Face {
    let direction = Face::ALL
        .into_iter()
        .find(|&face| from.across(face) == Some(to));
    direction.expect("cells of a segment are adjacent")
}
