//! Sweeps: ensembles over parameters of programs and scenes, and over settings, such as `sweep --vary 'bond.pull=2..12
//! N/5' --vary substeps=2,4`.
//!
//! An [`Axis`] has the values of one parameter or setting. [`points`] returns all combinations of
//! the axes. Each combination is a program of the ensemble. A [`Sweep`] contains the results.
//! `docs/guides/sweep.md` explains each of its fields.
mod axis;
mod data;
mod elasticity;
mod error;
mod outcome;
mod parameter;
mod points;

pub use axis::Axis;
pub(crate) use axis::{common, digits, logarithmic, value};
pub use elasticity::SweptElasticity;
pub use error::{MAX_POINTS, RangeError};
pub use outcome::{PointTally, Sweep, SweepPoint, SweepTally, SweptNumber, SweptValue};
pub use parameter::{Parameter, ParameterValue};
#[cfg(test)]
pub(crate) use points::number;
pub use points::{Point, points};
