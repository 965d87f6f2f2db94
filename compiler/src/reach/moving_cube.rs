//! Positions of a cube of one or two block lengths. In a planar world, it is a square.
use std::ops::Range;

use stochc_ir::Cell;

use super::occupancy::{Has, OccupiedCells};

/// A cube that moves in steps of a block length around a structure.
pub struct MovingCube<'a> {
    /// Occupied cells, sorted.
    pub occupancy: &'a OccupiedCells,
    pub has: Has<'a>,
    /// Edge of the cube in cells: 1 or 2.
    pub size: i32,
}

impl MovingCube<'_> {
    /// Returns whether a cube with low corner `at` overlaps an occupied cell.
    pub fn is_blocked(&self, at: Cell) -> bool {
        self.meets(at, 0, self.size)
    }

    /// Returns whether a cube overlaps an occupied cell. The cube extends from `low` to below
    /// `high` along each axis, relative to `at`.
    fn meets(&self, at: Cell, low: i32, high: i32) -> bool {
        let range = || low..high;
        range().any(|dz| {
            self.rows(low, high).any(|dy| {
                range().any(|dx| match at.offset([dx, dy, dz]) {
                    Some(cell) => self.occupancy.is_blocked(cell, self.has),
                    None => true,
                })
            })
        })
    }

    /// Returns the rows from `low` to below `high`, or the single row of a planar world.
    fn rows(&self, low: i32, high: i32) -> Range<i32> {
        if self.occupancy.plane.is_some() {
            0..1
        } else {
            low..high
        }
    }

    /// Returns whether an edge or a corner of a cube could touch anything except the ground.
    pub fn is_at_wall(&self, at: Cell) -> bool {
        (-1..=self.size).any(|dz| {
            self.rows(-1, self.size + 1).any(|dy| {
                (-1..=self.size).any(|dx| {
                    at.offset([dx, dy, dz]).is_some_and(|cell| {
                        !self.occupancy.is_ground(cell) && self.occupancy.is_blocked(cell, self.has)
                    })
                })
            })
        })
    }

    /// Returns the height of the block that stops a rising cube. Returns `None` if no block stops
    /// it.
    fn ceiling(&self, at: Cell) -> Option<i32> {
        let rows = || self.rows(0, self.size);
        let columns = (0..self.size).flat_map(|dx| rows().map(move |dy| (dx, dy)));
        columns
            .filter_map(|(dx, dy)| {
                let column = at.offset([dx, dy, 0])?;
                (self.occupancy).ceiling(column.x, column.y, column.z, self.has)
            })
            .min()
    }

    /// Returns the position below the block that stops a rising cube. Returns `None` if no block
    /// stops it.
    pub fn rise(&self, at: Cell) -> Option<Cell> {
        let z = self.ceiling(at)? - self.size;
        Some(Cell { z, ..at })
    }

    /// Returns whether a cube can rise from `at` to `z` without hitting a block.
    pub fn rises_to(&self, at: Cell, z: i32) -> bool {
        self.rise(at).is_none_or(|under| under.z >= z)
    }

    /// Returns whether a cube at `at` can rise to the sky.
    pub fn sees_sky(&self, at: Cell) -> bool {
        self.ceiling(at).is_none()
    }
}
