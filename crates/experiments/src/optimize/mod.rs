//! Optimization of parameters: the values with the shortest times.
//!
//! The caller simulates points of the parameters in rounds. After each round, the emulator of
//! [fits](crate::fit) predicts the objective. A [`PredictedOptimum`] is its minimum, with the box
//! that the next round simulates. Runs with other seeds confirm the last optimum.
//!
//! # Source
//!
//! G. E. P. Box and K. B. Wilson, J. R. Stat. Soc. B 13, 1 (1951).
mod confirmation;
mod constraint;
mod goal;
mod objective;
mod predicted;

pub use confirmation::{estimate, resampled};
pub use constraint::{ConfirmedConstraint, Constraint, ConstraintError};
pub use goal::Goal;
pub use objective::{Objective, ObjectiveError};
pub use predicted::{BestSimulated, OptimalNumber, Optimum, PredictedOptimum};
