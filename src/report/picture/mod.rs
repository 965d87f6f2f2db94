//! The figures of a report.
mod entries;
mod means;
mod origins;
mod survival;
mod waits;

pub(super) use entries::entries;
pub(super) use means::means;
pub(super) use origins::origins;
pub(super) use survival::{Curve, survival};
pub(super) use waits::{SHOWN, waits};

use crate::figures::short;

/// Of every figure.
const WIDTH: f64 = 760.0;
