//! Times and costs of the runs of one program with some settings.
use crate::statistics::{Observation, median};
use crate::{OutcomeCounts, completion_time};
use stochc_results::Finished;

/// Runs of one program with the same settings.
#[derive(Clone, Debug, Default)]
pub(super) struct Sample {
    /// Number of runs with each outcome.
    pub outcomes: OutcomeCounts,
    /// Completion times \[ticks\], except of runs whose computation failed.
    pub times: Vec<Observation>,
    /// CPU times of the runs whose CPU time was measured \[s\].
    cpu: Vec<f64>,
    /// Total ticks of the runs with a CPU time.
    ticks: u64,
}

impl Sample {
    pub fn add(&mut self, done: &Finished) {
        self.outcomes.add(&done.record.outcome);
        self.times.extend(completion_time(&done.record));
        if let Some(cpu) = done.cpu {
            self.cpu.push(cpu);
            self.ticks += done.record.ticks;
        }
    }

    /// Returns the median CPU time of a run \[s\]. Returns `None` if no CPU time is known.
    pub fn cost(&self) -> Option<f64> {
        median(&self.cpu)
    }

    /// Returns the CPU time of a tick \[s\], averaged over all runs. Returns `None` if no CPU time
    /// is known.
    pub fn cost_of_tick(&self) -> Option<f64> {
        (self.ticks > 0).then(|| self.cpu.iter().sum::<f64>() / self.ticks as f64)
    }
}
