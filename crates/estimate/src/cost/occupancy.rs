//! Occupied cells at each level of a phase.
use rustc_hash::FxHashMap;
use smallvec::{SmallVec, smallvec};
use stochc_ir::Cell;

use super::events::PhaseEvent;

/// Interval of levels during which a cell contains a block.
#[derive(Clone, Copy, Debug)]
struct OccupancyInterval {
    since: u32,
    /// Last level of the interval.
    until: u32,
}

/// Occupied cells of a structure at each level of a phase.
#[derive(Debug, Default)]
pub struct Occupancy {
    intervals: FxHashMap<Cell, SmallVec<[OccupancyInterval; 1]>>,
    /// For each cube of 4 x 4 x 4 cells, a bit set of the cells with intervals. Speeds up queries,
    /// because most queried cells are empty and close together.
    cubes: FxHashMap<[i32; 3], u64>,
}

/// Returns the cube of 4 x 4 x 4 cells around a cell, and the cell's bit.
fn cube(cell: Cell) -> ([i32; 3], u64) {
    let at = [cell.x, cell.y, cell.z];
    let [x, y, z] = at.map(|at| at & 3);
    (at.map(|at| at >> 2), 1 << (x + 4 * y + 16 * z))
}

impl Occupancy {
    /// Starts a phase. `events` contains the events of the phase in source order.
    pub fn begin(&mut self, events: &[PhaseEvent]) {
        for event in events.iter().filter(|event| !event.is_release()) {
            let intervals = self.intervals.entry(event.cell).or_default();
            let (cube, bit) = cube(event.cell);
            *self.cubes.entry(cube).or_default() |= bit;
            intervals.push(OccupancyInterval {
                since: event.level,
                until: u32::MAX,
            });
        }
        for event in events {
            let Some(since) = event.releases_since else {
                continue;
            };
            let intervals = self.intervals.get_mut(&event.cell).into_iter().flatten();
            for interval in intervals.filter(|interval| interval.since == since) {
                interval.until = event.level;
            }
        }
    }

    /// Returns whether a cell is occupied while the captures of a level wait. If `with_mates` is
    /// set, the cells that the same level captures also count as occupied.
    pub fn is_full(&self, cell: Cell, level: u32, with_mates: bool) -> bool {
        let (cube, bit) = cube(cell);
        if self.cubes.get(&cube).is_none_or(|bits| bits & bit == 0) {
            return false;
        }
        let intervals = self.intervals.get(&cell).into_iter().flatten();
        let mut intervals = intervals.filter(|interval| level <= interval.until);
        intervals.any(|interval| interval.since < level || (with_mates && interval.since == level))
    }

    /// Ends the phase. The remaining blocks exist from the start of the next phase.
    pub fn end(&mut self, events: &[PhaseEvent]) {
        for event in events {
            let Some(intervals) = self.intervals.get_mut(&event.cell) else {
                continue;
            };
            if intervals.iter().any(|interval| interval.until == u32::MAX) {
                *intervals = smallvec![OccupancyInterval {
                    since: 0,
                    until: u32::MAX,
                }];
            } else {
                self.intervals.remove(&event.cell);
                let (cube, bit) = cube(event.cell);
                *self.cubes.entry(cube).or_default() &= !bit;
            }
        }
    }
}
