//! Validates scenes from files.
use super::medium::Agitation;
use super::scalar_error::ScalarError;
use super::scalars;
use super::world::Scene;

impl Scene {
    /// Validates every number of the scene, which may come from a file.
    ///
    /// # Errors
    ///
    /// If a number is out of range.
    pub fn validate(&self) -> Result<(), InvalidScene> {
        for scalar in scalars::scalars(self) {
            if let Some(value) = scalar.get(self) {
                scalar.check(value)?;
            }
        }
        match &self.agitation {
            Some(Agitation::Kicks { speed }) if speed.0 > speed.1 => Err(InvalidScene::SpeedRange),
            _ => Ok(()),
        }
    }
}

/// Defect of a scene from a file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum InvalidScene {
    /// A number is out of range.
    #[error(transparent)]
    Scalar(#[from] ScalarError),
    /// The range of speeds of the random impulses is empty.
    #[error("`agitation.speed.low` is more than the upper end")]
    SpeedRange,
}
