//! Errors that prevent the record of a run.
use stochc_ir::state::StateError;

use crate::settings::Model;
use crate::world::SceneError;

/// Error that prevents the record of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum RunError {
    /// The scene cannot be set up.
    Scene(SceneError),
    /// The [`Watch`](crate::Watch) cancelled the run.
    Cancelled,
    /// Blocks have no positions in this model.
    Nowhere(Model),
    /// The run was measured in an experiment.
    Measured,
    /// This build does not contain the model.
    Absent(Model),
    /// The data of [`Watch::saved`](crate::Watch::saved) are not a state of this run.
    State(StateError),
}

impl std::fmt::Display for RunError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            RunError::Scene(error) => error.fmt(f),
            RunError::Cancelled => f.write_str("the run was cancelled"),
            RunError::Nowhere(model) => write!(
                f,
                "blocks have no positions in the model `{}`; use `--model rigid`",
                model.name()
            ),
            RunError::Measured => f.write_str(
                "the run was measured in an experiment, so it cannot be simulated again",
            ),
            RunError::Absent(model) => {
                write!(
                    f,
                    "this build does not contain the model `{}`",
                    model.name()
                )
            }
            RunError::State(error) => write!(f, "cannot resume from the saved state: {error}"),
        }
    }
}

impl std::error::Error for RunError {}

impl From<SceneError> for RunError {
    fn from(error: SceneError) -> RunError {
        RunError::Scene(error)
    }
}

impl From<StateError> for RunError {
    fn from(error: StateError) -> RunError {
        RunError::State(error)
    }
}
