//! Source files and locations in them.
pub(crate) mod load;
pub(crate) mod reader;
pub(crate) mod source;
pub mod source_map;
