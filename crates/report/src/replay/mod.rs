//! The replay page of a recording: one self-contained HTML file.
//!
//! The folder `page/` contains its parts. The page contains the recording unchanged and unpacks it
//! in parts during the replay.
mod about;
mod colours;
mod program_text;
mod text;
mod tour;
mod writing;

pub use about::about;
pub use program_text::EventLocation;
pub use tour::tour;
pub use writing::{MARK, write};
