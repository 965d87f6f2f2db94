//! What a run says of a time: the one place where outcomes become observations.
use stochc_ir::record::{Outcome, RunRecord};

use crate::statistics::Observation;

/// The time to completion of a run in ticks, censored where it was stopped; a failed run has none.
pub fn completion_time(record: &RunRecord) -> Option<Observation> {
    let ticks = record.ticks as f64;
    match record.outcome {
        Outcome::Completed => Some(Observation::completed(ticks)),
        Outcome::TimedOut { .. } => Some(Observation::censored(ticks)),
        Outcome::Failed { .. } => None,
    }
}

/// The time of a phase in ticks, censored where the run was stopped in it; `None`: the run failed or did not reach it.
pub fn phase_time(record: &RunRecord, phase: usize) -> Option<Observation> {
    match &record.outcome {
        Outcome::Failed { .. } => None,
        outcome => match record.phase_ticks.get(phase) {
            Some(&ticks) => Some(Observation::completed(ticks as f64)),
            None if record.phase_ticks.len() == phase && *outcome != Outcome::Completed => {
                let before: u64 = record.phase_ticks.iter().sum();
                let cut = record.ticks.saturating_sub(before);
                Some(Observation::censored(cut as f64))
            }
            None => None,
        },
    }
}
