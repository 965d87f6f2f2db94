//! Formats sources in one canonical layout.
//!
//! Only the space *between* tokens changes. Words, numbers and comments keep their text and order,
//! so the tree stays the same. The parser delivers the tokens.
//!
//! The layout keeps four decisions of the author:
//! - blank lines, at most one
//! - whether a short block is on one line
//! - which seeds of a plate or words of a scene share a line
//! - which words of a scene are separated by a wider gap
mod align;
mod block;
mod line;
mod scene;
mod source;
mod spacing;
mod statement;
mod whole_file;
mod width;

pub(crate) use whole_file::lay_out;
pub use whole_file::{FormatError, format};
pub(crate) use width::{INDENT, WIDTH};
