//! Descriptions of events, tests and differences.
mod event_label;
mod pairwise;
mod relative;

pub use event_label::event_labels;
pub use pairwise::{method, probability, sentence};
pub use relative::relative;
pub(crate) use relative::relative_size;
