//! Who looks on while a run goes, ends it, and keeps its state.
use std::io::Read;
use std::ops::ControlFlow;

use stochc_ir::state::{State, StateError, StateReader, StateWriter};
use stochc_ir::table::PhaseId;

use crate::run_error::RunError;

/// Writes the state of a run.
pub type Save<'a> = dyn FnMut(&mut StateWriter<'_>) -> Result<(), StateError> + 'a;

/// Looks on while a run goes, and may end it, or keep its state for another one to go on from.
///
/// Any `FnMut(u64, PhaseId) -> ControlFlow<()>` is one that keeps nothing.
pub trait Watch {
    /// Called before every tick with the number of ticks passed and the phase that is running;
    /// `Break` cancels the run.
    fn tick(&mut self, tick: u64, phase: PhaseId) -> ControlFlow<()>;

    /// Asked once, before the first tick, for what [`Watch::keep`] has kept of the same run.
    fn kept(&mut self) -> Option<Box<dyn Read>> {
        None
    }

    /// Asked after each [`Watch::tick`] whether the state at this tick is to be kept.
    fn wants_state(&mut self) -> bool {
        false
    }

    /// Keeps what `save` writes.
    fn keep(&mut self, _save: &mut Save<'_>) {}
}

impl<F: FnMut(u64, PhaseId) -> ControlFlow<()>> Watch for F {
    fn tick(&mut self, tick: u64, phase: PhaseId) -> ControlFlow<()> {
        self(tick, phase)
    }
}

/// Goes on from what was kept of a run, if there is anything; whether there is.
pub(crate) fn resume(
    watch: &mut (impl Watch + ?Sized),
    parts: &mut [&mut dyn State],
) -> Result<bool, StateError> {
    let Some(mut kept) = watch.kept() else {
        return Ok(false);
    };
    let mut reader = StateReader::new(&mut *kept);
    parts
        .iter_mut()
        .try_for_each(|part| part.restore(&mut reader))?;
    Ok(true)
}

/// Tells that a tick begins, and has the state kept if that is wanted.
///
/// # Errors
/// [`RunError::Cancelled`].
pub(crate) fn tell(
    watch: &mut (impl Watch + ?Sized),
    (tick, phase): (u64, PhaseId),
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
