//! Readable forms of tables and graphs: text, JSON and DOT.
mod graph_dot;
mod graph_json;
mod graph_text;
mod shell_json;
mod table_json;
mod table_text;

use std::fmt::{self, Display, Formatter};

pub use graph_dot::graph_dot;
pub use graph_json::graph_json;
pub use graph_text::{chain_text, graph_text};
pub use shell_json::shell_json;
pub use table_json::table_json;
pub use table_text::{duties_text, table_text};

/// Text that is generated while it is written, so that it is never in memory as a whole.
pub struct Text<F>(
    /// Function that writes the text.
    pub F,
);

impl<F: Fn(&mut Formatter<'_>) -> fmt::Result> Display for Text<F> {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        (self.0)(out)
    }
}
