//! Times and costs of the runs of one program at one setting.
use crate::completion_time;
use crate::statistics::{Observation, Status, median};
use stochc_results::Finished;

/// Runs of one program at one setting.
#[derive(Clone, Debug, Default)]
pub(super) struct Sample {
    /// Times to completion \[ticks\]. Failed runs have none.
    pub times: Vec<Observation>,
    /// Number of runs with failed physics.
    pub failed: usize,
    /// Known CPU times of runs \[s\].
    cpu: Vec<f64>,
    /// Total ticks of these runs.
    ticks: u64,
}

impl Sample {
    /// Adds a finished run.
    pub fn add(&mut self, done: &Finished) {
        match completion_time(&done.record) {
            Some(time) => self.times.push(time),
            None => self.failed += 1,
        }
        if let Some(cpu) = done.cpu {
            self.cpu.push(cpu);
            self.ticks += done.record.ticks;
        }
    }

    /// Returns the number of runs with this status.
    pub fn count(&self, status: Status) -> usize {
        let times = self.times.iter();
        times.filter(|time| time.status == status).count()
    }

    /// Returns the median CPU time of a run \[s\].
    pub fn cost(&self) -> Option<f64> {
        median(&self.cpu)
    }

    /// Returns the CPU time of a tick \[s\], averaged over all runs.
    pub fn cost_of_tick(&self) -> Option<f64> {
        (self.ticks > 0).then(|| self.cpu.iter().sum::<f64>() / self.ticks as f64)
    }
}
