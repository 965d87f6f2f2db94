//! What the runs of one program at one setting have shown.
use serde::{Deserialize, Serialize};
use stochc_ir::record::RunRecord;

use crate::completion_status;
use crate::statistics::{Observation, Runs, Status, median};

/// One run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Its number.
    pub run: u64,
    /// How it ended.
    pub end: End,
    /// Ticks until it ended.
    pub ticks: u64,
    /// Processor time of its thread \[s\].
    pub cpu: f64,
    /// Time on the wall \[s\].
    pub wall: f64,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// With the whole structure.
    Completed,
    /// Stopped before that.
    Censored,
    /// Ended by the timeout of a phase, so that it never completes.
    TimedOut,
    /// Its physics broke down.
    Failed,
}

impl Measured {
    /// What is kept of a record.
    pub fn new(record: &RunRecord, cpu: f64, wall: f64) -> Measured {
        Measured {
            run: record.run,
            end: match completion_status(&record.outcome) {
                Some(Status::Completed) => End::Completed,
                Some(Status::Censored) => End::Censored,
                Some(Status::Competing) => End::TimedOut,
                None => End::Failed,
            },
            ticks: record.ticks,
            cpu,
            wall,
        }
    }

    /// Whether it tells what it would be, had it been stopped after `limit` ticks.
    pub(super) fn tells(&self, limit: u64) -> bool {
        self.end != End::Censored || self.ticks >= limit
    }

    /// The same run, had it been stopped after `limit` ticks.
    pub(super) fn within(self, limit: u64) -> Measured {
        if self.ticks <= limit {
            return self;
        }
        let share = limit as f64 / self.ticks as f64;
        Measured {
            end: End::Censored,
            ticks: limit,
            cpu: self.cpu * share,
            ..self
        }
    }
}

/// Finished runs, in the order of their numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sample {
    runs: Vec<Measured>,
}

impl Sample {
    /// Sorts runs, and stops those that went on for longer than `limit`.
    pub fn new(mut runs: Vec<Measured>, limit: u64) -> Sample {
        runs.sort_by_key(|run| run.run);
        for run in &mut runs {
            *run = run.within(limit);
        }
        Sample { runs }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.runs.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// How many ended so.
    pub fn count(&self, end: End) -> usize {
        self.runs.iter().filter(|run| run.end == end).count()
    }

    /// Times to completion \[ticks\] by run, of a seed; a failed run has none.
    pub fn runs(&self, seed: u64) -> Runs {
        let time = |run: &Measured| {
            let ticks = run.ticks as f64;
            let time = match run.end {
                End::Completed => Observation::completed(ticks),
                End::Censored => Observation::censored(ticks),
                End::TimedOut => Observation::competing(ticks),
                End::Failed => return None,
            };
            Some((run.run, time))
        };
        Runs {
            seed,
            times: self.runs.iter().filter_map(time).collect(),
        }
    }

    /// The same times without their numbers.
    pub fn times(&self) -> Vec<Observation> {
        self.runs(0).observations()
    }

    /// The median of the processor time of a run \[s\].
    pub fn cost(&self) -> Option<f64> {
        median(&self.runs.iter().map(|run| run.cpu).collect::<Vec<_>>())
    }

    /// The processor time of a tick \[s\], over all runs.
    pub fn cost_of_tick(&self) -> Option<f64> {
        let ticks: f64 = self.runs.iter().map(|run| run.ticks as f64).sum();
        let cpu: f64 = self.runs.iter().map(|run| run.cpu).sum();
        (ticks > 0.0).then(|| cpu / ticks)
    }
}

/// A run as tests need it, which takes a second of processor time a tick.
#[cfg(test)]
pub(super) fn measured(run: u64, end: End, ticks: u64) -> Measured {
    Measured {
        run,
        end,
        ticks,
        cpu: ticks as f64,
        wall: 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_that_went_on_for_too_long_is_cut() {
        let runs = vec![
            measured(2, End::Failed, 10),
            measured(1, End::Completed, 400),
            measured(0, End::Completed, 100),
        ];
        let sample = Sample::new(runs, 200);
        let times = [Observation::completed(100.0), Observation::censored(200.0)];
        assert_eq!(sample.times(), times);
        let ends = [End::Completed, End::Censored, End::Failed];
        assert_eq!(ends.map(|end| sample.count(end)), [1, 1, 1]);
        assert_eq!(sample.cost(), Some(100.0));
        assert_eq!(sample.cost_of_tick(), Some(1.0));
    }
}
