//! Explorations: complete, shortest violation, and random samples.
use stochc_ir::table::Tables;

use super::expected::ProgramGoals;
use super::exploration::{Exploration, ExplorationBounds};
use super::faults::Faults;
use super::random_walk::Choose;
use super::report::{ExplorationReport, ExplorationVerdict, Violation};
use super::{breadth_first, checker, depth_first, describe, faults, random_walk};

impl<'a> Exploration<'a> {
    /// Runs the exploration. The limits apply to all choices of faults together.
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

    /// Returns the shortest violation without faults, after reduction. Returns `None` if there is
    /// none within the limits.
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

    pub(super) fn checker(&self) -> checker::PropertyChecker<'a> {
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
