//! Errors of finding a shape in a program.
use thiserror::Error;

/// Error of finding the shape to build.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NoGoal {
    /// The program declares no shape.
    #[error("it declares no shape")]
    NoShape,
    /// The program declares several shapes, and none is chosen.
    #[error("it declares {0}: name one with `--shape`")]
    Ambiguous(String),
    /// The program declares no shape of this name, and no other.
    #[error("it declares no shape `{0}`, nor any other")]
    NoSuchShape(String),
    /// The program declares other shapes.
    #[error("it declares no shape `{name}`, but {others}")]
    OtherShapes {
        /// Name of the shape.
        name: String,
        /// Names of the declared shapes.
        others: String,
    },
    /// The shape has errors.
    #[error("{0}")]
    Wrong(String),
    /// The shape has no cells.
    #[error("the shape cannot be read as cells")]
    NoCells,
}
