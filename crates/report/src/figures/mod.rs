//! Figures of ensembles, sweeps and trades (SVG and PDF), laid out for the width of their medium.
mod completion;
mod files;
mod fit;
mod maps;
mod means;
mod origins;
mod structure;
mod survival;
mod sweep;
mod trade;
mod waits;

pub(crate) use maps::{MapColumn, maps};
pub(crate) use means::means;
pub(crate) use origins::origins;
pub(crate) use survival::{SurvivalCurve, incomplete, survival};
pub(crate) use waits::{SHOWN, waits};

pub use crate::svg::{Drawing, Medium};
pub use completion::completion;
pub use files::{FigureFormat, Figures};
pub use fit::fit;
pub use structure::structure;
pub use sweep::pictures as sweep;
pub use trade::trade;

/// Margin around a figure, in units of a drawing.
const EDGE: f64 = 8.0;
