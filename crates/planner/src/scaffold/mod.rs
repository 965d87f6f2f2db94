//! Temporary blocks: masts from which far pieces of a target grow at the same time as the rest.
//!
//! A mast is a column beside the target, on a block of the plate. A piece is a way through the target from the end that a mast
//! holds towards the plate. A mast may also hold nothing, and guide blocks to what grows beside it. When all pieces are there they are handed over, block by block: each is let go and taken at once by the block
//! that holds it in the end, and stays where it is. Then the mast goes, and the rest grows.
mod dismantling;
mod roles;

use stochc_ir::{Cell, Face};

pub use dismantling::{Dismantling, HandOver, Mast};
pub use roles::{SitePart, SiteRoles};

/// Masts, and what grows from them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scaffolding {
    /// In the order in which they were added.
    pub pieces: Vec<MastPiece>,
    /// Masts that need not hold anything, and their heights: free blocks are guided by them to what grows beside them.
    pub guides: Vec<((i32, i32), i32)>,
}

/// What grows from one place of a mast.
#[derive(Clone, Debug, PartialEq)]
pub struct MastPiece {
    /// The place of the mast on the plate.
    pub foot: (i32, i32),
    /// The layer of the mast's block that holds the piece.
    pub height: i32,
    /// From that block to the first cell.
    pub way: Face,
    /// The cells, from the mast on.
    pub cells: Vec<Cell>,
    /// What holds the last cell in the end: a cell of the target.
    pub join: Cell,
}

impl Scaffolding {
    /// The masts: their places on the plate and their heights, each once.
    pub fn masts(&self) -> Vec<((i32, i32), i32)> {
        let mut masts: Vec<((i32, i32), i32)> = Vec::new();
        let holding = self.pieces.iter().map(|piece| (piece.foot, piece.height));
        for (foot, height) in holding.chain(self.guides.iter().copied()) {
            match masts.iter_mut().find(|(known, _)| *known == foot) {
                Some((_, highest)) => *highest = height.max(*highest),
                None => masts.push((foot, height)),
            }
        }
        masts
    }

    /// Whether there is no mast.
    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty() && self.guides.is_empty()
    }

    /// The cells of the masts, each from the plate on.
    pub fn cells(&self) -> impl Iterator<Item = Cell> {
        let masts = self.masts().into_iter();
        masts.flat_map(|((x, y), height)| (1..=height).map(move |z| Cell::new(x, y, z)))
    }
}

impl MastPiece {
    /// Each cell with the way into it from the one before, from the mast on.
    pub fn grown(&self) -> impl Iterator<Item = (Cell, Face)> {
        let steps = self.cells.windows(2).map(|two| way(two[0], two[1]));
        (self.cells.iter().copied()).zip(std::iter::once(self.way).chain(steps))
    }

    /// Each cell with the way into it from what holds it in the end, in the order in which they are handed over.
    pub fn handed_over(&self) -> impl Iterator<Item = (Cell, Face)> {
        let holders = std::iter::once(self.join).chain(self.cells.iter().rev().copied());
        let cells = self.cells.iter().rev().copied();
        cells
            .zip(holders)
            .map(|(cell, holder)| (cell, way(holder, cell)))
    }
}

/// The face of a cell towards one beside it.
fn way(from: Cell, to: Cell) -> Face {
    let ways = Face::ALL
        .into_iter()
        .find(|&face| from.across(face) == Some(to));
    ways.expect("cells of a piece are beside each other")
}
