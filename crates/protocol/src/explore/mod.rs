//! Event tables in every order of events.
//!
//! [`explore`] runs the very machine that runs in a world ([`Structure`](crate::Structure)), but instead of a
//! clock and chance it tries every order: any face that is on may capture next, if its cell is
//! empty, and any message may make its next hop next, however long another one has been under way.
//! Each hop is a transition of its own, because a message that is halfway can find the structure changed
//! (a name has been given, a block is gone). Channels keep no order: two messages between the same
//! two blocks may overtake each other. That the plate begins a phase is one transition, as in a run.
//!
//! Every order of a world is among them, whatever the price of a hop, so what holds here holds
//! there. What is not explored is time: a phase that waits for ever here times out there.
//!
//! A state is hashed by what it means: the blocks by their roles, what they know as sorted sets,
//! messages under way as a bag. `persistent` leaves out orders that make no difference, and says why
//! that is sound.
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

/// Whether a free block can come to a cell while others are occupied (those of the plate, at
/// z = 0, are not listed).
///
/// It has to be monotone: a cell that cannot be reached cannot be reached either when more cells
/// are occupied.
pub type CanReach<'a> = dyn Fn(&BTreeSet<Cell>, Cell) -> bool + 'a;

/// How far an exploration goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExplorationBounds {
    /// States visited, at most; default 1,000,000.
    pub states: u64,
    /// Bytes that the visited states and the way to the present one may take, about; default 1 GB.
    pub memory: usize,
    /// Steps and rules looked at and blocks copied, at most, about; default 2 * 10^9, minutes.
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

/// What is explored, and how.
#[derive(Clone, Copy)]
pub struct Exploration<'a> {
    /// The tables that run.
    pub tables: &'a Tables,
    /// The goals of the tables: [`ProgramGoals::new`], unless the tables are in doubt.
    pub expected: &'a ProgramGoals,
    /// How far to go.
    pub bounds: ExplorationBounds,
    /// What may go wrong.
    pub faults: Faults,
    /// Which cells a free block can come to; `None`: every empty one.
    pub reach: Option<&'a CanReach<'a>>,
    /// Whether to leave out orders that make no difference; the verdict is the same.
    pub reduce: bool,
    /// Whether to count hangs and go on, rather than to take one for a violation.
    pub hangs_allowed: bool,
}

impl<'a> Exploration<'a> {
    /// Every order, with nothing in the way.
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

    /// Explores; the bounds hold for all together.
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

    /// The shortest order of events that goes wrong without any faults, of those that matter, if there is one
    /// within as many states and as much memory as the bounds allow.
    pub fn shortest(&self) -> Option<Violation> {
        match breadth_first::shortest(self, &faults::FaultChoice::default()) {
            ExplorationVerdict::Violated(violation) => Some(*violation),
            _ => None,
        }
    }

    /// Tries `schedules` orders that `choose` draws by chance instead of all; each choice of those whom
    /// faults strike is drawn as well.
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
