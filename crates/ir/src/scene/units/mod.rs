//! Units of scene values, as powers of the base units.
mod dimension;
mod scale;
mod suggested;
mod written;

pub use dimension::{BASES, Dimension, PREFIXES, Prefix, to_si};
pub use scale::Scale;
pub use suggested::{UNITS, converted, suggested_unit};
pub use written::{InvalidQuantity, WrittenQuantity, corrected};
