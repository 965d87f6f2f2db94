//! The structure in a form to read: text, JSON and SVG. Tables and graphs are shown by [`stochc_ir::emit`].
pub(crate) mod lower;
mod structure;

pub use structure::{built_structure, structure_json, structure_text};
