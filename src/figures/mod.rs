//! Pictures of measurements: SVG without a library, and small plots in a terminal.
//!
//! What is drawn does not know where it will be shown: colours are classes that follow the
//! reader's light or dark, every picture has a title and a description for those who cannot see it.
mod drawing;
mod duration;
mod palette;
mod scale;
mod short;
mod strip;
mod svg;
mod visible;

pub(crate) use drawing::Drawing;
pub(crate) use duration::{Tick, seconds};
pub(crate) use palette::{DASHES, STYLE, class};
pub(crate) use scale::{Scale, number, percent};
pub(crate) use short::short;
pub(crate) use strip::{Strip, strips};
pub(crate) use svg::{line, text};
pub(crate) use visible::{escaped, visible};
