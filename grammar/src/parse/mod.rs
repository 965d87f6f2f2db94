//! Parses a source, one sequence of pieces at a time.
mod brace;
mod build;
mod expr;
mod frame;
mod grammar;
mod limits;
mod open_block;
mod parser;
mod record;
mod recover;
mod scene;
mod spans;
mod trivia;
mod whole_file;
mod window;
mod words;

pub(crate) use grammar::{Rule, SaParser};
pub use limits::{MAX_DEPTH, MAX_ERRORS, MAX_STATEMENT, MAX_TERMS};
pub(crate) use record::{Record, Token};
pub use trivia::is_comment;
pub(crate) use whole_file::parse_recorded;
pub use whole_file::{Parsed, accepts, is_unit, parse, parse_cancellable};
