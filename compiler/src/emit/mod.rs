//! Every stage in a form to read: text, JSON, DOT and SVG.
mod graph_dot;
mod graph_text;
mod json;
mod structure;
mod table_text;

pub use graph_dot::graph_dot;
pub use graph_text::{chain_text, graph_text};
pub use json::{graph_json, table_json};
pub use structure::{structure_json, structure_svg, structure_text};
pub use table_text::{duties_text, table_text};
