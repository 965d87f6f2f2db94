//! Errors of finding a shape in a program.
use thiserror::Error;

/// Reason why no shape to build was found.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum NoGoal {
    /// The program does not declare a shape.
    #[error("it declares no shape")]
    NoShape,
    /// The program declares several shapes, and none is chosen.
    #[error("it declares {0}: name one with `--shape`")]
    Ambiguous(String),
    /// The program declares no shapes. Contains the requested name.
    #[error("it declares no shape `{0}`, nor any other")]
    NoSuchShape(String),
    /// The program declares shapes, but none with the requested name.
    #[error("it declares no shape `{name}`, but {others}")]
    OtherShapes {
        /// Name of the missing shape.
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
