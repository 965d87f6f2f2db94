//! Pictures of measurements: SVG without a library, and small plots in a terminal.
//!
//! What is drawn does not know where it will be shown: colours are classes that follow the
//! reader's light or dark, every picture has a title and a description for those who cannot see it.
mod drawing;
mod element;
mod palette;
mod scale;
mod symbol;

pub use drawing::Drawing;
pub(crate) use palette::{Colours, DASHES, STYLE, class, phase};
pub(crate) use scale::Scale;
pub(crate) use symbol::Marker;
