//! JSON that is written in parts, and JSON without unknown fields.
pub(crate) mod strict;
pub(crate) mod value;
