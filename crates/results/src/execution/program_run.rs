//! Single runs of a program.
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use stochc_ir::record::RunRecord;
use stochc_runtime::observe::Observer;
use stochc_runtime::world::SceneError;
use stochc_runtime::{RunError, Settings, Watch};

use crate::manifest::EnsembleProgram;

impl EnsembleProgram {
    /// Makes a run.
    ///
    /// # Errors
    ///
    /// The errors of [`stochc_runtime::run()`].
    pub fn run(
        &self,
        settings: &Settings,
        seed: u64,
        run: u64,
        watch: &mut impl Watch,
    ) -> Result<RunRecord, RunError> {
        let (tables, scene) = (self.tables(), &self.scene);
        stochc_runtime::run(tables, scene, settings, seed, run, watch)
    }

    /// Makes a run with an observer. The record is the same.
    ///
    /// # Errors
    ///
    /// The errors of [`stochc_runtime::observe()`].
    pub fn observe(
        &self,
        settings: &Settings,
        seed: u64,
        run: u64,
        watch: &mut impl Watch,
        observer: &mut impl Observer,
    ) -> Result<RunRecord, RunError> {
        let (tables, scene) = (self.tables(), &self.scene);
        stochc_runtime::observe(tables, scene, settings, seed, run, watch, observer)
    }

    /// Checks that the scene of the program can be set up.
    ///
    /// # Errors
    ///
    /// Returns the reason if the scene cannot be set up.
    pub fn try_out(&self, settings: &Settings) -> Result<(), SceneError> {
        let mut stop = |_, _| ControlFlow::Break(());
        match self.run(settings, 0, 0, &mut stop) {
            Err(RunError::Scene(error)) => Err(error),
            _ => Ok(()),
        }
    }
}

/// Returns `Break` if `stop` is set, otherwise `Continue`.
pub fn unless(stop: &AtomicBool) -> ControlFlow<()> {
    if stop.load(Ordering::Relaxed) {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}

/// Returns a watch that cancels a run when `stop` is set.
pub fn until(stop: &AtomicBool) -> impl Watch {
    |_, _| unless(stop)
}
