//! Every stage in a form to read: text, JSON, DOT and SVG.
mod graph_dot;
mod graph_text;
mod json;
mod structure;
mod table_text;

use std::fmt::{self, Display, Formatter};

pub use graph_dot::graph_dot;
pub use graph_text::{chain_text, graph_text};
pub use json::{graph_json, table_json};
pub use structure::{structure_json, structure_svg, structure_text};
pub use table_text::{duties_text, table_text};

/// Text that is written as it is made, so that nothing holds all of it.
struct Text<F>(F);

impl<F: Fn(&mut Formatter<'_>) -> fmt::Result> Display for Text<F> {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        (self.0)(out)
    }
}
