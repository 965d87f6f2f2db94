//! Limit of the time step by the springs of a scene.
use super::SceneError;
use super::external_forces::response;
use super::parameters::WorldParameters;
use crate::settings::Settings;

impl WorldParameters {
    /// Checks the length of the steps.
    ///
    /// # Errors
    ///
    /// If a spring turns by more than one radian per step or, with drag, overshoots by more than
    /// its displacement. Beyond twice that it gains energy.
    pub fn check(&self, settings: &Settings) -> Result<(), SceneError> {
        let [substeps, _] = self.rates(settings);
        let Some(shell) = self.shell else {
            return Ok(());
        };
        // Drag reduces the effect of a force in a step that is long compared with its relaxation
        // time.
        let drag = self.fluid.map_or(0.0, |fluid| fluid.viscous.0);
        let swings =
            |substeps: f64| shell.stiffness * response(drag / substeps) > substeps * substeps;
        if swings(f64::from(substeps)) {
            let (mut few, mut enough) = (f64::from(substeps), shell.stiffness.sqrt().ceil());
            while enough - few > 1.0 {
                let middle = ((few + enough) / 2.0).floor();
                // Numbers so large that none is between them.
                if middle <= few || middle >= enough {
                    break;
                }
                if swings(middle) {
                    few = middle;
                } else {
                    enough = middle;
                }
            }
            let (what, substeps) = ("the wall", enough as u64);
            return Err(SceneError::TooStiff { what, substeps });
        }
        Ok(())
    }
}
