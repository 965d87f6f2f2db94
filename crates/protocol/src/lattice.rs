//! Cells, and who sits in them: the geometry of a structure without anything that moves.
use std::collections::{BTreeMap, BTreeSet};

use stochc_ir::{Cell, Face};

use crate::body::{BlockFace, Body, Docking};
use crate::orientation::Orientation;

/// Which blocks are anchored where, which faces are on, and which hold a block.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Lattice {
    /// The anchored blocks that were free once, by number.
    placed: BTreeMap<u32, LatticePose>,
    /// Which block sits in a cell above the plate.
    cells: BTreeMap<Cell, u32>,
    /// The faces that are on and hold nothing.
    active: BTreeSet<BlockFace>,
    /// The faces that hold a block.
    holds: BTreeMap<BlockFace, u32>,
}

/// Where an anchored block is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LatticePose {
    /// In which cell it sits.
    pub cell: Cell,
    /// And how.
    pub orientation: Orientation,
}

impl Lattice {
    /// The occupied cells above the plate, each with the number of its block.
    pub fn cells(&self) -> &BTreeMap<Cell, u32> {
        &self.cells
    }

    /// The faces that are on and hold nothing.
    pub fn active(&self) -> &BTreeSet<BlockFace> {
        &self.active
    }

    /// Where a block is anchored; `None`: it is not.
    pub fn place(&self, body: Body) -> Option<LatticePose> {
        match body {
            Body::Seed(cell) => Some(LatticePose {
                cell,
                orientation: Orientation::IDENTITY,
            }),
            Body::Free(id) => self.placed.get(&id).copied(),
        }
    }

    /// The block that a face holds.
    pub fn held(&self, site: BlockFace) -> Option<u32> {
        self.holds.get(&site).copied()
    }

    /// Whether a block that was free once is anchored.
    pub fn is_anchored(&self, id: u32) -> bool {
        self.placed.contains_key(&id)
    }

    /// Where a block that docks on `site` would sit; `None`: there is no room.
    pub fn target(&self, site: BlockFace) -> Option<Cell> {
        let parent = self.place(site.body)?;
        let cell = parent
            .cell
            .across(parent.orientation.to_structure(site.face))?;
        (cell.z >= 1 && !self.cells.contains_key(&cell)).then_some(cell)
    }

    /// Switches a face on, unless it holds a block.
    pub fn magnetize(&mut self, site: BlockFace) {
        if self.place(site.body).is_some() && !self.holds.contains_key(&site) {
            self.active.insert(site);
        }
    }

    /// Switches a face off; what it holds goes, with all that hangs on it.
    pub fn switch_off(&mut self, site: BlockFace) {
        self.active.remove(&site);
        let Some(id) = self.holds.remove(&site) else {
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

    /// Anchors a block where there is room for it.
    pub fn dock(&mut self, docking: &Docking) {
        let site = docking.site;
        let (Some(parent), Some(cell)) = (self.place(site.body), self.target(site)) else {
            return;
        };
        let Docking {
            child, child_face, ..
        } = *docking;
        let orientation =
            Orientation::docked(parent.orientation, site.face, child_face, docking.turn);
        self.placed.insert(child, LatticePose { cell, orientation });
        self.cells.insert(cell, child);
        self.active.remove(&site);
        self.holds.insert(site, child);
    }
}
