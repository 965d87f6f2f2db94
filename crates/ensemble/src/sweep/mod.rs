//! Ensembles over scene parameters and settings: `simulate --sweep 'bond.pull=2..12 N/5' --sweep substeps=2,4`.
//!
//! An [`Axis`] is what the user says of one of them; [`points`] makes all combinations of the values
//! of several, each of which is a program of the ensemble. What came of them is a [`Sweep`], which `data.rs` writes down. `docs/sweep.md` says what each figure means.
mod axis;
mod data;
mod outcome;
mod points;

pub use axis::Axis;
pub(crate) use axis::{common, digits, logarithmic, value, varied};
pub use outcome::{PointTally, Sweep, SweepPoint, SweepTally, SweptNumber, SweptValue};
pub(crate) use points::number;
pub use points::{MAX_POINTS, Point, points};
