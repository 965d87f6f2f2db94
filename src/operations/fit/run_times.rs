//! Completion times and waiting times of runs.
use stochc_experiments::statistics::Observation;
use stochc_experiments::{OutcomeCounts, WaitsTally, completion_time};
use stochc_results::Records;

use crate::exit::Failure;

/// Times of the runs of a program \[ticks\].
#[derive(Clone, Debug, Default)]
pub(super) struct RunTimes {
    /// Completion times, except of runs whose computation failed.
    pub completion: Vec<Observation>,
    pub waits: WaitsTally,
    /// Number of runs with each outcome.
    pub outcomes: OutcomeCounts,
    /// Number of aborted attempts at phases.
    pub aborts: usize,
}

/// Returns the times of each of the `programs`.
///
/// # Errors
/// If the records cannot be read.
pub(super) fn run_times(records: &Records, programs: usize) -> Result<Vec<RunTimes>, Failure> {
    let mut times = vec![RunTimes::default(); programs];
    let read = records.each(|done| {
        let times: &mut RunTimes = &mut times[done.program];
        times.completion.extend(completion_time(&done.record));
        times.waits.add(&done.record);
        times.outcomes.add(&done.record.outcome);
        times.aborts += done.record.aborts.len();
    });
    read.map_err(Failure::usage)?;
    Ok(times)
}
