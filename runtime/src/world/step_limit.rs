//! Whether the steps are short enough for the springs of a scene.
use super::SceneError;
use super::external_forces::response;
use super::parameters::WorldParameters;
use crate::settings::Settings;

impl WorldParameters {
    /// Whether the steps are short enough.
    ///
    /// # Errors
    /// If a spring would turn by more than one radian in a step, or, slowed by drag, swing back by more than it
    /// was out: from twice as much on it gains energy.
    pub fn check(&self, settings: &Settings) -> Result<(), SceneError> {
        let [substeps, _] = self.rates(settings);
        let Some(shell) = self.shell else {
            return Ok(());
        };
        // Drag takes up what it can of a step that is longer than it needs to slow a block.
        let drag = self.fluid.map_or(0.0, |fluid| fluid.viscous.0);
        let swings =
            |substeps: f64| shell.stiffness * response(drag / substeps) > substeps * substeps;
        if swings(f64::from(substeps)) {
            let (mut few, mut enough) = (f64::from(substeps), shell.stiffness.sqrt().ceil());
            while enough - few > 1.0 {
                let middle = ((few + enough) / 2.0).floor();
                // So large that there is no number between them.
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
