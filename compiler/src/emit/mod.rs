//! Every stage in a form to read: text, JSON and DOT.
mod graph_dot;
mod graph_text;
mod json;
mod table_text;

pub use graph_dot::graph_dot;
pub use graph_text::{chain_text, graph_text};
pub use json::{graph_json, table_json};
pub use table_text::table_text;
