//! Prints the structure as text, JSON, SVG and STL. [`stochc_ir::emit`] prints tables and graphs.
pub(crate) mod lower;
mod stl;
mod structure;

pub use stl::structure_stl;
pub use structure::{built_structure, structure_json, structure_text};
