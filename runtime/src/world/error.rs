//! Scenes that cannot be set up.
use stochc_estimate::InaccurateRates;
use stochc_ir::scene::room::NoRoom;

use super::motion_limits::FARTHEST;

/// Reason why a scene cannot be set up.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneError {
    /// The free blocks do not fit.
    NoRoom(NoRoom),
    /// Jets need a wall, and there is none.
    NoWall,
    /// A quantity is negative, NaN, or outside the range of single precision.
    NotANumber {
        /// Quoted name of a scene parameter, or a description.
        what: String,
        /// Value of the quantity, in block units if it has a unit.
        value: f64,
    },
    /// A spring oscillates too fast for the step and would throw blocks out.
    TooStiff {
        /// Description of the spring.
        what: &'static str,
        /// Smallest sufficient number of substeps per tick.
        substeps: u64,
    },
    /// A free block would start too far from the plate for single precision.
    TooFar {
        /// Distance \[block lengths\].
        distance: f64,
    },
    /// The scene has not been calibrated.
    NoRates,
    /// The held-out error of the rates is too large.
    InaccurateRates(InaccurateRates),
    /// The model lacks a feature that the scene or the settings need.
    NotInModel {
        /// Description of the feature, a noun without article.
        what: &'static str,
        /// Name of the model on the command line.
        model: &'static str,
        /// Name of a model with this feature.
        instead: &'static str,
    },
}

impl From<NoRoom> for SceneError {
    fn from(error: NoRoom) -> SceneError {
        SceneError::NoRoom(error)
    }
}

impl From<InaccurateRates> for SceneError {
    fn from(error: InaccurateRates) -> SceneError {
        SceneError::InaccurateRates(error)
    }
}

impl std::fmt::Display for SceneError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            SceneError::NoRoom(error) => error.fmt(f),
            SceneError::NoWall => f.write_str("jets need an enclosure to come from"),
            SceneError::NotANumber { what, value } => {
                write!(
                    f,
                    "{what} is {value:e} in block units, which cannot be simulated"
                )
            }
            SceneError::TooFar { distance } => write!(
                f,
                "a free block would start {distance:.1e} block lengths from the plate; use a smaller enclosure, with at \
                 most {FARTHEST:.0e} block lengths"
            ),
            SceneError::InaccurateRates(error) => error.fmt(f),
            SceneError::NoRates => {
                f.write_str("this scene has no calibrated rates; run `stochc calibrate`")
            }
            SceneError::TooStiff { what, substeps } => write!(
                f,
                "{what} is too stiff for steps this long; use `--substeps {substeps}`, or a tick \
                 shorter by that factor"
            ),
            SceneError::NotInModel {
                what,
                model,
                instead,
            } => write!(
                f,
                "the model `{model}` does not support {what}; use `--model {instead}`"
            ),
        }
    }
}

impl std::error::Error for SceneError {}
