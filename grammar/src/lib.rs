//! Parser, printer and formatter of the language.
//!
//! [`parse`] turns the source of one file into a [`tree::Tree`] and a list of [`SyntaxError`]s. It
//! always returns both. No size or nesting of the source can exhaust the stack.
//!
//! [`print()`] turns a tree into source that parses to the same tree. [`format`](format()) formats
//! a source in one canonical layout and keeps comments. The grammar is `src/sa.pest`. No other
//! crate uses its rules.
mod cancellation;
mod error;
mod format;
mod parse;
mod print;
mod scan;
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
pub use scan::{Part, PartKind, code, parts};
pub use span::Span;
pub use symbol::{BEGINNINGS, CONTINUATIONS, Symbol, Symbols};

/// Byte order mark. Some editors write it at the start of a file. It has no meaning in UTF-8.
pub const BYTE_ORDER_MARK: &str = "\u{feff}";
