//! Pictures (SVG) of ensembles, sweeps and trades.
mod completion;
mod entries;
mod fit;
mod means;
mod origins;
mod survival;
mod sweep;
mod trade;
mod waits;

pub(crate) use entries::entries;
pub(crate) use means::means;
pub(crate) use origins::origins;
pub(crate) use survival::{SurvivalCurve, survival};
pub(crate) use waits::{SHOWN, waits};

pub use completion::completion;
pub(crate) use completion::completion_so_far;
pub use fit::fit;
pub use sweep::pictures as sweep;
pub use trade::trade;

use crate::text::short;

/// Of every figure.
const WIDTH: f64 = 760.0;
