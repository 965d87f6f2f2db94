//! Number of runs with each outcome.
use stochc_ir::record::{Limit, Outcome};

/// Number of runs with each outcome.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OutcomeCounts {
    /// Number of completed runs.
    pub completed: usize,
    /// Number of runs that timed out in a phase. They never complete.
    pub timed_out: usize,
    /// Number of runs that reached the limit of ticks. Their times are right-censored.
    pub censored: usize,
    /// Number of runs whose structure broke. They never complete.
    pub broken: usize,
    /// Number of runs whose computation failed. They have no time.
    pub invalid: usize,
}

impl OutcomeCounts {
    /// Adds a run.
    pub fn add(&mut self, outcome: &Outcome) {
        let count = match outcome {
            Outcome::Completed => &mut self.completed,
            Outcome::TimedOut { by, .. } => match by {
                Limit::Timeout => &mut self.timed_out,
                Limit::MaxTicks => &mut self.censored,
            },
            Outcome::Failed {
                is_broken: true, ..
            } => &mut self.broken,
            Outcome::Failed { .. } => &mut self.invalid,
        };
        *count += 1;
    }

    /// Returns the number of runs.
    pub fn finished(&self) -> usize {
        self.completed + self.timed_out + self.censored + self.failed()
    }

    /// Returns the number of runs whose computation failed, or whose structure broke.
    pub fn failed(&self) -> usize {
        self.broken + self.invalid
    }
}

#[cfg(test)]
mod tests {
    use stochc_ir::table::PhaseId;

    use super::*;

    #[test]
    fn every_run_has_one_outcome() {
        let phase = PhaseId(0);
        let timed_out = |by| Outcome::TimedOut { phase, by };
        let failed = |is_broken| Outcome::Failed {
            phase,
            reason: String::new(),
            is_broken,
        };
        let mut counts = OutcomeCounts::default();
        for (outcome, runs) in [
            (Outcome::Completed, 1),
            (timed_out(Limit::Timeout), 2),
            (timed_out(Limit::MaxTicks), 3),
            (failed(true), 4),
            (failed(false), 5),
        ] {
            (0..runs).for_each(|_| counts.add(&outcome));
        }
        let expected = OutcomeCounts {
            completed: 1,
            timed_out: 2,
            censored: 3,
            broken: 4,
            invalid: 5,
        };
        assert_eq!(counts, expected);
        assert_eq!((counts.finished(), counts.failed()), (15, 9));
    }
}
