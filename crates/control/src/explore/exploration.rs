//! Task of an exploration.
use std::collections::BTreeSet;

use stochc_ir::Cell;
use stochc_ir::table::Tables;

use super::expected::ProgramGoals;
use super::faults::Faults;

/// Function that returns whether a free block can reach a cell while other cells are occupied.
/// Cells of the plate, at z = 0, are not listed.
///
/// The function must be monotone: occupying more cells never makes a cell reachable.
pub type CanReach<'a> = dyn Fn(&BTreeSet<Cell>, Cell) -> bool + 'a;

/// Limits of an exploration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExplorationBounds {
    /// Largest number of visited states. Default: 1,000,000.
    pub states: u64,
    /// Approximate memory limit of the visited states and the current path \[bytes\]. Default: 1
    /// GB.
    pub memory: usize,
    /// Approximate limit of steps, evaluated rules and copied blocks. Default: 2 * 10^9, which
    /// takes minutes.
    pub work: u64,
}

impl Default for ExplorationBounds {
    fn default() -> ExplorationBounds {
        ExplorationBounds {
            states: 1_000_000,
            memory: 1_000_000_000,
            work: 2_000_000_000,
        }
    }
}

/// Exploration task.
#[derive(Clone, Copy)]
pub struct Exploration<'a> {
    /// Tables to run.
    pub tables: &'a Tables,
    /// Goals to check the tables against. [`ProgramGoals::new`] derives them from the tables.
    /// [`ProgramGoals::from_events`] takes an independent declaration, so that the tables themselves
    /// are checked.
    pub expected: &'a ProgramGoals,
    /// Limits.
    pub bounds: ExplorationBounds,
    /// Injected faults.
    pub faults: Faults,
    /// Reachability of cells. `None` if every empty cell is reachable.
    pub reach: Option<&'a CanReach<'a>>,
    /// Whether to omit equivalent orders. The verdict is the same.
    pub reduce: bool,
    /// Whether to count deadlocks and continue instead of reporting a violation.
    pub hangs_allowed: bool,
}

impl<'a> Exploration<'a> {
    /// Returns an exploration of all orders of events. Every empty cell counts as reachable.
    pub fn new(
        tables: &'a Tables,
        expected: &'a ProgramGoals,
        bounds: ExplorationBounds,
        faults: Faults,
    ) -> Exploration<'a> {
        Exploration {
            tables,
            expected,
            bounds,
            faults,
            reach: None,
            reduce: true,
            hangs_allowed: false,
        }
    }
}
