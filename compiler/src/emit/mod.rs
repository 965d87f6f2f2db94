//! Prints the structure as text, JSON and SVG. [`stochc_ir::emit`] prints tables and graphs.
pub(crate) mod lower;
mod structure;

pub use structure::{built_structure, structure_json, structure_text};
