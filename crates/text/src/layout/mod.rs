//! Tables, paragraphs and curves of plain text.
mod line;
mod markup;
mod paragraph;
mod short;
mod table;

pub use line::aligned;
pub use markup::Markup;
pub use paragraph::paragraph;
pub use short::short;
pub use table::{TextColumn, TextTable};
