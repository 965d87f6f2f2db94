//! State of a run in progress, from its record.
use stochc_estimate::{EventState, PartialRun};
use stochc_ir::record::{Limit, Outcome, RunRecord};

use crate::EnsembleProgram;
use crate::records::ProgramEvents;

/// Returns the state of a right-censored run. Returns `None` if the run has ended, or the program
/// is an aggregate.
pub fn partial_run(program: &EnsembleProgram, record: &RunRecord) -> Option<PartialRun> {
    let Outcome::TimedOut {
        phase,
        by: Limit::MaxTicks,
    } = record.outcome
    else {
        return None;
    };
    if program.tables().aggregate.is_some() {
        return None;
    }
    let times = ProgramEvents::new(program).times(record).ok()?;
    let events = times.into_iter().map(|times| match times {
        None => EventState::Pending,
        Some(times) => match times.done {
            Some(tick) => EventState::Happened(tick as f64),
            None => EventState::Open(times.ready as f64),
        },
    });
    let now = record.ticks as f64;
    let recovery = program.phases().get(phase.0 as usize)?.recovery;
    let retries = recovery.map_or(0, |recovery| recovery.retries);
    let aborts = || record.aborts.iter().filter(|abort| abort.phase == phase);
    let began = match aborts().next_back() {
        None => record.phase_ticks.iter().sum::<u64>() as f64,
        Some(abort) => abort.retried.map_or_else(
            || now + recovery.map_or(0.0, |recovery| recovery.pause as f64),
            |tick| tick as f64,
        ),
    };
    Some(PartialRun {
        now,
        phase,
        began,
        retries: retries.saturating_sub(aborts().count() as u32),
        events: events.collect(),
    })
}
