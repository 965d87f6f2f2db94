//! Treats parts of a goal that are attached to no capturing block: removes them, or supports them
//! with more cells.
use std::collections::BTreeSet;

use crate::{LoosePart, TargetError, declaration};
use stochc_ir::Cell;

use super::definition::Goal;

impl Goal {
    /// Removes the loose parts from the goal, and returns them.
    pub fn drop_loose(&mut self) -> Vec<LoosePart> {
        let loose = self.loose();
        if !loose.is_empty() {
            let dropped: BTreeSet<Cell> = loose.iter().flat_map(|it| it.cells.clone()).collect();
            let cells = self.cells.iter().copied();
            self.set_cells(cells.filter(|cell| !dropped.contains(cell)).collect());
        }
        loose
    }

    /// Adds cells that support the loose parts, and returns these cells.
    pub fn add_supports(&mut self) -> Vec<Cell> {
        let bridges = self.loose().into_iter().filter_map(|part| part.bridge);
        let supports: Vec<Cell> = bridges.flatten().collect();
        if !supports.is_empty() {
            self.set_cells(self.cells.iter().chain(&supports).copied().collect());
        }
        supports
    }

    fn loose(&self) -> Vec<LoosePart> {
        let target = self.target(self.scene().ok().as_ref(), u32::MAX);
        match target {
            Err(TargetError::Loose(parts)) => parts,
            _ => Vec::new(),
        }
    }

    fn set_cells(&mut self, mut cells: Vec<Cell>) {
        cells.sort_unstable();
        cells.dedup();
        self.shape = declaration(&self.name, &cells);
        self.cells = cells;
    }
}
