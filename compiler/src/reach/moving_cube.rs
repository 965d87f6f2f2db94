//! Where a cube of one side or two can be, and rise to.
use stochc_ir::Cell;

use super::occupancy::{Has, OccupiedCells};

/// A cube that moves in steps of a side among what stands.
pub struct MovingCube<'a> {
    /// The structure, sorted.
    pub occupancy: &'a OccupiedCells,
    /// Which of its captures have happened.
    pub has: Has<'a>,
    /// Edge of the cube that has to get through, in cells: 1 or 2.
    pub size: i32,
}

impl MovingCube<'_> {
    /// Whether a cube with its low corner at `at` meets a blocked cell.
    pub fn is_blocked(&self, at: Cell) -> bool {
        self.meets(at, 0, self.size)
    }

    /// Whether one of the cells of a cube from `low` to below `high`, seen from `at`, is blocked.
    fn meets(&self, at: Cell, low: i32, high: i32) -> bool {
        let range = || low..high;
        range().any(|dz| {
            range().any(|dy| {
                range().any(|dx| match at.offset([dx, dy, dz]) {
                    Some(cell) => self.occupancy.is_blocked(cell, self.has),
                    None => true,
                })
            })
        })
    }

    /// Whether a cube could touch something with an edge or a corner, the ground apart.
    pub fn is_at_wall(&self, at: Cell) -> bool {
        (-1..=self.size).any(|dz| {
            (-1..=self.size).any(|dy| {
                (-1..=self.size).any(|dx| {
                    at.offset([dx, dy, dz]).is_some_and(|cell| {
                        cell.z >= 1 && self.occupancy.is_blocked(cell, self.has)
                    })
                })
            })
        })
    }

    /// The height of what stops a cube on its way up; `None`: nothing.
    fn ceiling(&self, at: Cell) -> Option<i32> {
        let columns = (0..self.size).flat_map(|dx| (0..self.size).map(move |dy| (dx, dy)));
        columns
            .filter_map(|(dx, dy)| {
                let column = at.offset([dx, dy, 0])?;
                (self.occupancy).ceiling(column.x, column.y, column.z, self.has)
            })
            .min()
    }

    /// The place under what stops a free cube on its way up; `None`: nothing does.
    pub fn rise(&self, at: Cell) -> Option<Cell> {
        let z = self.ceiling(at)? - self.size;
        Some(Cell { z, ..at })
    }

    /// Whether nothing stops a cube that is free at `at` on its way up to `z`.
    pub fn rises_to(&self, at: Cell, z: i32) -> bool {
        self.rise(at).is_none_or(|under| under.z >= z)
    }

    /// Whether a cube that is free at `at` can rise to the sky.
    pub fn sees_sky(&self, at: Cell) -> bool {
        self.ceiling(at).is_none()
    }
}
