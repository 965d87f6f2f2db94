//! Scenes that cannot be set up.
use stochc_ir::scene::room::NoRoom;

/// Why a scene cannot be set up.
#[derive(Clone, Debug, PartialEq)]
pub enum SceneError {
    /// Its free blocks have no room.
    NoRoom(NoRoom),
    /// Jets have no wall to come from.
    NoWall,
    /// A quantity is negative, or too large or small for single precision, or not a number.
    NotANumber {
        /// Which: the quoted name of a number of scenes, or words.
        what: String,
        /// Its value; where it makes sense, in block units.
        value: f64,
    },
    /// A spring swings too fast for the step, and would throw blocks out instead of back.
    TooStiff {
        /// Which spring.
        what: &'static str,
        /// How many substeps resolve it.
        substeps: u64,
    },
    /// Nobody has measured the rates of the scene.
    NoRates,
    /// The model cannot compute something that the scene or the settings ask for.
    NotInModel {
        /// What, as a noun without its article.
        what: &'static str,
        /// The model, by its name on the command line.
        model: &'static str,
        /// A model that can.
        instead: &'static str,
    },
}

impl From<NoRoom> for SceneError {
    fn from(error: NoRoom) -> SceneError {
        SceneError::NoRoom(error)
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
            SceneError::NoRates => {
                f.write_str("there are no rates of this scene; `stochc calibrate` measures them")
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
                "the model `{model}` has no {what}; `stochc simulate --model {instead}` has it"
            ),
        }
    }
}

impl std::error::Error for SceneError {}
