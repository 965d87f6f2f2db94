//! Exploration of event tables in every order of events.
//!
//! [`explore`] runs the same state machine as a world ([`Structure`](crate::Structure)), but in
//! every order instead of by clock and chance. Any open face whose cell is empty may capture next.
//! Any message may make its next hop, however long others have been in transit. Each hop is a
//! transition, because the structure can change while a message is halfway. Contacts keep no order:
//! two messages between the same blocks may overtake each other. As in a run, the beginning of a
//! phase is one transition.
//!
//! This includes every order of a world, for any hop time, so properties proved here hold in all
//! worlds. Time is not explored: a phase that never ends here times out in a world.
//!
//! States are hashed by meaning: blocks by role, observations as sorted sets, messages in transit
//! as a multiset. `persistent` omits equivalent orders and proves that this is sound.
mod breadth_first;
mod checker;
mod context;
mod depth_first;
mod describe;
mod effects;
mod environment;
mod expected;
mod faults;
mod fingerprint;
mod future;
mod persistent;
mod progress;
mod random_walk;
mod report;
mod roles;
mod state;
mod transition;

use std::collections::BTreeSet;

use stochc_ir::Cell;
use stochc_ir::table::Tables;

pub use expected::{Meant, ProgramGoals};
pub use faults::Faults;
pub use random_walk::{Choose, DrawIndex};
pub use report::{ExceededBound, ExplorationReport, ExplorationVerdict, Property, Violation};

/// Predicate: a free block can reach a cell while others are occupied. Cells of the plate, at z =
/// 0, are not listed.
///
/// It must be monotone: occupying more cells never makes a cell reachable.
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
    /// Goals of the tables. Usually [`ProgramGoals::new`]; a separate declaration checks the tables
    /// themselves.
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
    /// Returns the task of exploring every order, with all cells reachable.
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

    /// Explores. The limits apply to all choices of faults together.
    pub fn run(&self) -> ExplorationReport {
        let mut report = ExplorationReport::empty(ExplorationVerdict::Holds);
        for struck in self.faults.choices(self.tables, self.expected) {
            let left = ExplorationBounds {
                states: self.bounds.states - report.states.min(self.bounds.states),
                work: self.bounds.work - report.work.min(self.bounds.work),
                ..self.bounds
            };
            let exploration = Exploration {
                bounds: left,
                ..*self
            };
            depth_first::DepthFirst::new(&exploration, &struck).run(&mut report);
            report.choices += 1;
            if report.verdict != ExplorationVerdict::Holds {
                break;
            }
        }
        report
    }

    /// Returns the shortest violation without faults, after reduction, if there is one within the
    /// limits.
    pub fn shortest(&self) -> Option<Violation> {
        match breadth_first::shortest(self, &faults::FaultChoice::default()) {
            ExplorationVerdict::Violated(violation) => Some(*violation),
            _ => None,
        }
    }

    /// Explores `schedules` random orders, drawn by `choose`, instead of all. The blocks affected
    /// by faults are drawn as well.
    pub fn sample(&self, schedules: u64, choose: &mut Choose<'_>) -> ExplorationReport {
        random_walk::sample(self, schedules, choose)
    }

    fn checker(&self) -> checker::PropertyChecker<'a> {
        checker::PropertyChecker {
            expected: self.expected,
            describer: describe::Describer {
                tables: self.tables,
            },
        }
    }
}

/// Explores tables in every order of events.
pub fn explore(tables: &Tables, bounds: &ExplorationBounds, faults: &Faults) -> ExplorationReport {
    let expected = ProgramGoals::new(tables);
    Exploration::new(tables, &expected, *bounds, *faults).run()
}
