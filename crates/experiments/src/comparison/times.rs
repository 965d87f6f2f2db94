//! Conversion of outcomes of runs to observations, for all statistics.
use stochc_ir::record::{Limit, Outcome, RunRecord};

use crate::statistics::{Observation, Status};
use stochc_results::{JournalError, Records};

/// Returns the completion time of a run in ticks. Returns `None` if the computation failed.
///
/// A run that reached its limit of ticks is censored. A run never completes if it timed out in a
/// phase, or if its structure broke. It is not censored, because timeouts stop only slow runs.
pub fn completion_time(record: &RunRecord) -> Option<Observation> {
    Some(Observation {
        time: record.ticks as f64,
        status: completion_status(&record.outcome)?,
    })
}

/// Returns the [`Status`] of events that did not happen before the end of a run with this outcome.
/// Returns `None` if the computation failed.
pub fn completion_status(outcome: &Outcome) -> Option<Status> {
    match outcome {
        Outcome::Completed => Some(Status::Completed),
        Outcome::TimedOut { by, .. } => Some(match by {
            Limit::Timeout => Status::Competing,
            Limit::MaxTicks => Status::Censored,
        }),
        Outcome::Failed { is_broken, .. } => is_broken.then_some(Status::Competing),
    }
}

/// Sorts runs by completion time, the fastest first. A right-censored run comes after all runs that
/// completed in the same time or less. Runs that never complete come last.
pub fn sort_by_time(runs: &mut [(u64, Observation)]) {
    runs.sort_by(|(_, a), (_, b)| {
        let times = a.at_risk_until().total_cmp(&b.at_risk_until());
        times.then(b.is_completed().cmp(&a.is_completed()))
    });
}

/// Returns the number of the run with the program's median completion time. Returns `None` if no
/// run has a time.
///
/// # Errors
///
/// If the runs cannot be read again.
pub fn median_run(finished: &Records, program: usize) -> Result<Option<u64>, JournalError> {
    let mut times = Vec::new();
    let keys = finished.keys().filter(|&(of, _)| of == program);
    finished.try_each_of(keys, |done| {
        times.extend(completion_time(&done.record).map(|time| (done.record.run, time)));
        Ok::<(), JournalError>(())
    })?;
    sort_by_time(&mut times);
    let middle = times.len().saturating_sub(1) / 2;
    Ok(times.get(middle).map(|&(run, _)| run))
}

/// Returns the duration of a phase \[ticks\]. It is censored if the run ended in this phase.
/// Returns `None` if the computation failed or the run did not reach the phase.
pub fn phase_time(record: &RunRecord, phase: usize) -> Option<Observation> {
    if record.outcome.is_invalid() {
        return None;
    }
    match record.phase_ticks.get(phase) {
        Some(&ticks) => Some(Observation::completed(ticks as f64)),
        None if record.phase_ticks.len() == phase && record.outcome != Outcome::Completed => {
            let before: u64 = record.phase_ticks.iter().sum();
            let cut = record.ticks.saturating_sub(before);
            Some(Observation::censored(cut as f64))
        }
        None => None,
    }
}

#[cfg(test)]
mod tests {
    use stochc_ir::record::{Limit, Outcome, RunRecord};
    use stochc_ir::table::PhaseId;

    use super::{completion_time, phase_time};
    use crate::statistics::Observation;

    /// Checks a run that is stopped in its second phase, 30 ticks after the start of the phase.
    #[test]
    fn timeouts_and_breaks_never_complete_and_a_tick_limit_censors() {
        let phase = PhaseId(1);
        let ended = |outcome| RunRecord {
            phase_ticks: vec![70],
            ..RunRecord::without_bonds(0, outcome, 100)
        };
        let stopped = |by| ended(Outcome::TimedOut { phase, by });
        let failed = |is_broken| {
            let reason = String::new();
            ended(Outcome::Failed {
                phase,
                reason,
                is_broken,
            })
        };
        let [timeout, limit] = [Limit::Timeout, Limit::MaxTicks].map(stopped);
        let [error, broken] = [false, true].map(failed);
        for run in [&timeout, &broken] {
            assert_eq!(completion_time(run), Some(Observation::competing(100.0)));
        }
        assert_eq!(completion_time(&limit), Some(Observation::censored(100.0)));
        assert_eq!(completion_time(&error), None);
        assert_eq!(phase_time(&error, 0), None);
        for run in [timeout, limit, broken] {
            assert_eq!(phase_time(&run, 0), Some(Observation::completed(70.0)));
            assert_eq!(phase_time(&run, 1), Some(Observation::censored(30.0)));
            assert_eq!(phase_time(&run, 2), None);
        }
    }
}
