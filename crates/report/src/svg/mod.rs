//! Drawings of results: SVG and PDF.
//!
//! A drawing does not depend on its background. Its colours are style classes that follow the
//! reader's light or dark theme. Every drawing has a title and a description for screen readers.
//! Its [`Medium`] determines its width, and figures are laid out for this width.
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
pub(crate) use style::{Colours, Paint, STYLE, Style, class, dashes};
