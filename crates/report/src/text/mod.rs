//! Plain text: columns, paragraphs, curves and sentences.
mod event_label;
mod line;
mod markup;
mod pairwise;
mod paragraph;
mod short;
mod strip;
mod table;

pub use event_label::event_labels;
pub use line::aligned;
pub use markup::Markup;
pub use pairwise::{method, probability, sentence};
pub use paragraph::paragraph;
pub(crate) use short::short;
pub use strip::{Strip, strips};
pub use table::{TextColumn, TextTable};
