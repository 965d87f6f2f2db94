//! Units of scene values, as powers of the base units.
mod dimension;
mod meant;
mod scale;
mod written;

pub use dimension::{BASES, Dimension, PREFIXES, Prefix, to_si};
pub use meant::{UNITS, converted, unit_meant};
pub use scale::Scale;
pub use written::{InvalidQuantity, WrittenQuantity};
