//! Limit of the time step by the springs of a scene.
use super::SceneError;
use super::external_forces::response;
use super::parameters::WorldParameters;
use crate::settings::Settings;

impl WorldParameters {
    /// Checks that the steps are short enough for the elastic wall.
    ///
    /// # Errors
    ///
    /// If the phase of an oscillation in the wall advances by more than one radian per step. Under
    /// strong drag, if a step corrects more than the whole displacement. Beyond twice this limit,
    /// the oscillation would gain energy.
    pub fn check(&self, settings: &Settings) -> Result<(), SceneError> {
        let [substeps, _] = self.rates(settings);
        let Some(wall) = self.wall else {
            return Ok(());
        };
        // In a step that is long compared with its relaxation time, drag reduces the effect of a
        // force.
        let drag = self.fluid.map_or(0.0, |fluid| fluid.viscous.0);
        let swings =
            |substeps: f64| wall.stiffness * response(drag / substeps) > substeps * substeps;
        if swings(f64::from(substeps)) {
            let (mut few, mut enough) = (f64::from(substeps), wall.stiffness.sqrt().ceil());
            while enough - few > 1.0 {
                let middle = ((few + enough) / 2.0).floor();
                // At this size, no floating-point number is between the two bounds.
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
