//! Lattice geometry of a structure: cells and their blocks, without motion.
use std::collections::{BTreeMap, BTreeSet};

use stochc_ir::{Cell, Face};

use crate::body::{BlockFace, Body, Docking};
use crate::orientation::Orientation;

/// Anchored blocks with their cells, open faces, and holding faces.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Lattice {
    /// Anchored blocks that were free at the start, by number.
    placed: BTreeMap<u32, LatticePose>,
    /// Block in each occupied cell above the plate.
    cells: BTreeMap<Cell, u32>,
    /// Open faces.
    active: BTreeSet<BlockFace>,
    /// Faces that hold a block, each with the number of the block.
    holds: BTreeMap<BlockFace, u32>,
}

/// Cell and orientation of an anchored block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LatticePose {
    /// Cell of the block.
    pub cell: Cell,
    /// Orientation of the block.
    pub orientation: Orientation,
}

impl Lattice {
    /// Returns the occupied cells above the plate, each with its block.
    pub fn cells(&self) -> &BTreeMap<Cell, u32> {
        &self.cells
    }

    /// Returns the open faces.
    pub fn active(&self) -> &BTreeSet<BlockFace> {
        &self.active
    }

    /// Returns the cell and orientation of an anchored block. Returns `None` if the block is not
    /// anchored.
    pub fn pose(&self, body: Body) -> Option<LatticePose> {
        match body {
            Body::Seed(cell) => Some(LatticePose {
                cell,
                orientation: Orientation::IDENTITY,
            }),
            Body::Free(id) => self.placed.get(&id).copied(),
        }
    }

    /// Returns the block that a face holds. Returns `None` if it holds none.
    pub fn held(&self, block_face: BlockFace) -> Option<u32> {
        self.holds.get(&block_face).copied()
    }

    /// Returns whether a formerly free block is anchored.
    pub fn is_anchored(&self, id: u32) -> bool {
        self.placed.contains_key(&id)
    }

    /// Returns the cell that a block captured at `block_face` would occupy. Returns `None` if no block
    /// can be captured there.
    pub fn target(&self, block_face: BlockFace) -> Option<Cell> {
        let parent = self.pose(block_face.body)?;
        let cell = parent
            .cell
            .across(parent.orientation.to_structure(block_face.face))?;
        (cell.z >= 1 && !self.cells.contains_key(&cell)).then_some(cell)
    }

    /// Switches a face on unless it holds a block.
    pub fn magnetize(&mut self, block_face: BlockFace) {
        if self.pose(block_face.body).is_some() && !self.holds.contains_key(&block_face) {
            self.active.insert(block_face);
        }
    }

    /// Switches a face off and releases its block with all descendants.
    pub fn switch_off(&mut self, block_face: BlockFace) {
        self.active.remove(&block_face);
        let Some(id) = self.holds.remove(&block_face) else {
            return;
        };
        if let Some(placed) = self.placed.remove(&id) {
            self.cells.remove(&placed.cell);
        }
        for face in Face::ALL {
            let body = Body::Free(id);
            self.switch_off(BlockFace { body, face });
        }
    }

    /// Anchors a captured block if its cell is empty.
    pub fn dock(&mut self, docking: &Docking) {
        let block_face = docking.block_face;
        let (Some(parent), Some(cell)) = (self.pose(block_face.body), self.target(block_face))
        else {
            return;
        };
        let Docking {
            child, child_face, ..
        } = *docking;
        let orientation = Orientation::docked(
            parent.orientation,
            block_face.face,
            child_face,
            docking.turn,
        );
        self.placed.insert(child, LatticePose { cell, orientation });
        self.cells.insert(cell, child);
        self.active.remove(&block_face);
        self.holds.insert(block_face, child);
    }
}
