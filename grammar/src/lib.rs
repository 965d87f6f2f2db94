//! Text to syntax tree, and back.
//!
//! [`parse`] turns the text of one file into a [`tree::Tree`] and a list of [`SyntaxError`]s; it
//! always gives both, and neither the size nor the nesting of the text can exhaust the stack.
//! [`print()`] turns a tree into text that parses to the same tree, and [`format`](format()) lays a
//! text out in the one canonical way, comments included. The grammar itself is `src/sa.pest`; no
//! other crate names a rule of it.
mod cancellation;
mod error;
mod format;
mod parse;
mod print;
mod span;
mod symbol;
pub mod tree;

pub use cancellation::{Cancellation, Cancelled};
pub use error::{SyntaxError, SyntaxErrorKind};
pub use format::{FormatError, format};
pub use parse::{
    MAX_DEPTH, MAX_ERRORS, MAX_STATEMENT, MAX_TERMS, Parsed, accepts, is_comment, is_unit, parse,
    parse_cancellable,
};
pub use print::print;
pub use span::Span;
pub use symbol::{Symbol, Symbols};

/// The mark of the byte order, with which some editors begin a text: it says nothing in UTF-8.
pub const BYTE_ORDER_MARK: &str = "\u{feff}";
