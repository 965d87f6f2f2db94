//! Why there is no record of a run.
use stochc_ir::state::StateError;

use crate::settings::Model;
use crate::world::SceneError;

/// Why a run left no record.
#[derive(Clone, Debug, PartialEq)]
pub enum RunError {
    /// The scene cannot be set up.
    Scene(SceneError),
    /// The [`Watch`](crate::Watch) ended it.
    Cancelled,
    /// The model has no places to look at.
    Nowhere(Model),
    /// What [`Watch::kept`](crate::Watch::kept) has given is no state of this run.
    State(StateError),
}

impl std::fmt::Display for RunError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            RunError::Scene(error) => error.fmt(f),
            RunError::Cancelled => f.write_str("the run was cancelled"),
            RunError::Nowhere(model) => write!(
                f,
                "the model `{}` has no places to look at; `--model rigid` has them",
                model.name()
            ),
            RunError::State(error) => write!(f, "the state to go on from cannot be used: {error}"),
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
