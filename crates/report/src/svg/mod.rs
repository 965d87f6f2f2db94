//! Pictures of measurements: SVG and PDF.
//!
//! What is drawn does not know where it will be shown: colours are classes that follow the
//! reader's light or dark, every picture has a title and a description for those who cannot see it. How wide it is
//! its [`Medium`] says, and figures lay themselves out for that.
mod axis;
mod drawing;
pub(crate) mod letters;
mod markup;
mod medium;
mod pdf;
mod scale;
mod shape;
mod style;

pub use drawing::Drawing;
pub use medium::Medium;

pub(crate) use axis::PlotAxis;
pub(crate) use drawing::{LINE, LegendEntry, LegendSymbol};
pub(crate) use medium::plot_height;
pub(crate) use scale::Scale;
pub(crate) use shape::Marker;
pub(crate) use style::{Colours, Paint, STYLE, Style, class, dashes, phase};
