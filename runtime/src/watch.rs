//! Supervision of a run: progress, cancellation and checkpoints.
use std::io::Read;
use std::ops::ControlFlow;

use stochc_ir::state::{State, StateError, StateReader, StateWriter};
use stochc_ir::table::PhaseId;

use crate::run_error::RunError;

/// Function that writes the state of a run.
pub type Save<'a> = dyn FnMut(&mut StateWriter<'_>) -> Result<(), StateError> + 'a;

/// Supervisor of a run. It can cancel the run or save its state for resuming.
///
/// Any `FnMut(u64, PhaseId) -> ControlFlow<()>` is a watch without checkpoints.
pub trait Watch {
    /// Receives the number of completed ticks and the running phase before every tick. `Break`
    /// cancels the run.
    fn tick(&mut self, tick: u64, phase: PhaseId) -> ControlFlow<()>;

    /// Returns the saved state of the same run, if there is one. Called once, before the first
    /// tick.
    fn saved(&mut self) -> Option<Box<dyn Read>> {
        None
    }

    /// Returns whether to save the state at this tick. Called after each [`Watch::tick`].
    fn wants_state(&mut self) -> bool {
        false
    }

    /// Saves the state that `save` writes.
    fn keep(&mut self, _save: &mut Save<'_>) {}
}

impl<F: FnMut(u64, PhaseId) -> ControlFlow<()>> Watch for F {
    fn tick(&mut self, tick: u64, phase: PhaseId) -> ControlFlow<()> {
        self(tick, phase)
    }
}

/// Restores the state that was saved for this run. Returns `false` if none was saved.
pub(crate) fn resume(
    watch: &mut (impl Watch + ?Sized),
    parts: &mut [&mut dyn State],
) -> Result<bool, StateError> {
    let Some(mut saved) = watch.saved() else {
        return Ok(false);
    };
    let mut reader = StateReader::new(&mut *saved);
    parts
        .iter_mut()
        .try_for_each(|part| part.restore(&mut reader))?;
    Ok(true)
}

/// Reports that a tick begins, and saves the state if requested.
///
/// # Errors
///
/// [`RunError::Cancelled`], if the watch cancels the run.
pub(crate) fn report_tick(
    watch: &mut (impl Watch + ?Sized),
    tick: u64,
    phase: PhaseId,
    parts: &[&dyn State],
) -> Result<(), RunError> {
    let flow = watch.tick(tick, phase);
    if watch.wants_state() {
        watch.keep(&mut |to| parts.iter().try_for_each(|part| part.save(to)));
    }
    match flow {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(RunError::Cancelled),
    }
}
