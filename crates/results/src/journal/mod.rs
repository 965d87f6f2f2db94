//! The journal of finished runs.
mod error;
mod file;
mod line;

pub use error::JournalError;
pub(crate) use file::{
    Journal, JournalHeader, ShardHeader, Shortest, most_line, read, read_header, read_lines, run,
    salvaged,
};
pub(crate) use line::{line, read_at, read_line};
