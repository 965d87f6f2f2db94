//! Occupied cells at a state of a phase.
//!
//! In a planar world, the cells are turned ([`Plane`]), and there is no ground.
use std::collections::BTreeSet;

use rustc_hash::{FxHashMap, FxHashSet};
use stochc_ir::Cell;

use super::plane::Plane;
use crate::expanded::EventId;

/// Function that returns whether a capture has happened.
pub type Has<'a> = &'a dyn Fn(EventId) -> bool;

/// Occupied cells, including cells that captures of the current phase fill.
#[derive(Clone, Default)]
pub struct OccupiedCells {
    /// Capture that fills each cell.
    cells: FxHashMap<Cell, EventId>,
    /// Cells that a capture of the phase fills although a previous block may still be there.
    retained: FxHashSet<Cell>,
    /// Highest occupied cell at each (x, y).
    tops: FxHashMap<(i32, i32), i32>,
    /// Occupied cells sorted by (x, y, z). Computed on demand.
    sorted: Option<BTreeSet<(i32, i32, i32)>>,
    /// Number of blocks that [`OccupiedCells::ceiling`] has visited.
    passed: std::cell::Cell<u64>,
    /// Plane of a planar world.
    pub plane: Option<Plane>,
    /// Cells of the seeds of a planar world. They are always occupied.
    seeds: FxHashSet<Cell>,
}

impl OccupiedCells {
    pub fn with_capacity(count: usize) -> OccupiedCells {
        OccupiedCells {
            cells: FxHashMap::with_capacity_and_hasher(count, Default::default()),
            ..OccupiedCells::default()
        }
    }

    /// Marks a cell as filled by a seed, in a planar world.
    pub fn fill_by_seed(&mut self, cell: Cell) {
        self.seeds.insert(cell);
        self.raise(cell);
    }

    fn raise(&mut self, cell: Cell) {
        let top = self.tops.entry((cell.x, cell.y)).or_insert(cell.z);
        *top = cell.z.max(*top);
    }

    /// Marks a cell as filled by a capture. A previous block may still be in it.
    pub fn fill(&mut self, cell: Cell, by: EventId) {
        if self.cells.insert(cell, by).is_some() {
            self.retained.insert(cell);
        }
        self.raise(cell);
        if let Some(sorted) = &mut self.sorted {
            sorted.insert((cell.x, cell.y, cell.z));
        }
    }

    /// Removes the block that `capture` anchored. May be called only if its release certainly
    /// happens.
    pub fn empty(&mut self, cell: Cell, capture: EventId) {
        if self.cells.get(&cell) != Some(&capture) {
            self.retained.remove(&cell);
            return;
        }
        self.cells.remove(&cell);
        self.sort();
        let Some(sorted) = &mut self.sorted else {
            return;
        };
        let Cell { x, y, z } = cell;
        sorted.remove(&(x, y, z));
        match sorted
            .range((x, y, i32::MIN)..=(x, y, i32::MAX))
            .next_back()
        {
            Some(&(_, _, top)) => self.tops.insert((x, y), top),
            None => self.tops.remove(&(x, y)),
        };
    }

    /// Returns the event that fills a cell. Returns `None` if the cell is empty.
    pub fn at(&self, cell: Cell) -> Option<EventId> {
        self.cells.get(&cell).copied()
    }

    /// Returns whether all cells of a column from `z` on are empty.
    pub fn is_clear(&self, x: i32, y: i32, z: i32) -> bool {
        self.tops.get(&(x, y)).is_none_or(|&top| top < z)
            && self.wall_above(Cell::new(x, y, z)).is_none()
    }

    /// Returns whether a cell is the highest occupied one of its column, and no wall is above it.
    pub fn is_top(&self, cell: Cell) -> bool {
        self.tops.get(&(cell.x, cell.y)) == Some(&cell.z) && self.wall_above(cell).is_none()
    }

    fn wall_above(&self, cell: Cell) -> Option<i32> {
        self.plane.and_then(|plane| plane.wall_above(cell))
    }

    /// Sorts the cells. [`OccupiedCells::ceiling`] requires sorted cells.
    pub fn sort(&mut self) {
        let cells = self.cells.keys().chain(&self.seeds);
        self.sorted
            .get_or_insert_with(|| cells.map(|cell| (cell.x, cell.y, cell.z)).collect());
    }

    /// Returns whether a cell is blocked. Three things can block it: the ground, a block whose
    /// capture has happened, and a block that may not have left. `has` returns whether a capture
    /// has happened.
    pub fn is_blocked(&self, cell: Cell, has: Has) -> bool {
        self.is_fixed(cell)
            || (self.cells.get(&cell)).is_some_and(|&by| has(by) || self.is_retained(cell))
    }

    /// Returns whether the ground, a seed or a wall of a plane always blocks a cell.
    fn is_fixed(&self, cell: Cell) -> bool {
        match &self.plane {
            Some(plane) => plane.is_wall(cell) || self.seeds.contains(&cell),
            None => cell.z < 1,
        }
    }

    /// Returns whether a cell is in the ground.
    pub fn is_ground(&self, cell: Cell) -> bool {
        self.plane.is_none() && cell.z < 1
    }

    /// Returns whether a capture of the phase fills the cell while a previous block may still be
    /// there.
    pub fn is_retained(&self, cell: Cell) -> bool {
        !self.retained.is_empty() && self.retained.contains(&cell)
    }

    /// Returns the height of the lowest blocked cell of a column from `z` on. Requires
    /// [`OccupiedCells::sort`]. Returns `None` if no cell is blocked.
    pub fn ceiling(&self, x: i32, y: i32, z: i32, has: Has) -> Option<i32> {
        if self.is_clear(x, y, z) {
            return None;
        }
        let wall = self.wall_above(Cell::new(x, y, z));
        let sorted = self.sorted.as_ref()?;
        let block = (sorted.range((x, y, z)..=(x, y, i32::MAX)))
            .map(|&(x, y, z)| Cell::new(x, y, z))
            .inspect(|_| self.passed.set(self.passed.get() + 1))
            .find(|&cell| self.is_blocked(cell, has))
            .map(|cell| cell.z);
        block.into_iter().chain(wall).min()
    }

    /// Returns the number of blocks visited in [`OccupiedCells::ceiling`] since the last call.
    pub fn take_passed(&self) -> u64 {
        self.passed.take()
    }
}
