//! Parses whole files.
use pest::Parser as _;
use rustc_hash::FxHashSet;

use super::grammar::{Rule, SaParser};
use super::parser::Parser;
use super::record::Record;
use crate::error::{SyntaxError, SyntaxErrorKind};
use crate::tree::Tree;
use crate::{Cancellation, Cancelled, Span, Symbol, Symbols};

/// Result of parsing a file.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// Everything that could be read.
    pub tree: Tree,
    /// Errors in source order.
    pub errors: Vec<SyntaxError>,
    /// Words of skipped parts. Unknown names with these words are not reported.
    pub uncertain: FxHashSet<Symbol>,
}

/// Parses a file.
///
/// A broken statement is reported in [`Parsed::errors`] and omitted from the tree. Reading
/// continues after it.
pub fn parse(text: &str, symbols: &mut Symbols) -> Parsed {
    read(text, symbols, None, Cancellation::NEVER).0
}

/// Parses a source like [`parse`], and can be cancelled.
///
/// # Errors
///
/// Returns [`Cancelled`] if parsing was cancelled.
pub fn parse_cancellable(
    text: &str,
    symbols: &mut Symbols,
    cancellation: Cancellation<'_>,
) -> Result<Parsed, Cancelled> {
    let (parsed, _) = read(text, symbols, None, cancellation);
    // Cancelled parsing is incomplete.
    cancellation.check()?;
    Ok(parsed)
}

/// Parses a source like [`parse`], and also returns every token in order.
pub(crate) fn parse_recorded(text: &str, symbols: &mut Symbols) -> (Parsed, Record) {
    let record = Some(Record::default());
    let (parsed, record) = read(text, symbols, record, Cancellation::NEVER);
    (parsed, record.unwrap_or_default())
}

/// Returns the byte of the first bracket of a JSON file. Returns `None` for other files.
///
/// A program never begins with a bracket followed by a quotation mark or by another bracket.
fn json_begins(text: &str) -> Option<usize> {
    let begun = text.trim_start();
    let inside = begun.strip_prefix(['{', '['])?.trim_start();
    (inside.starts_with(['"', '{', '['])).then(|| text.len() - begun.len())
}

pub(super) fn read<'t>(
    text: &'t str,
    symbols: &mut Symbols,
    record: Option<Record>,
    cancellation: Cancellation<'t>,
) -> (Parsed, Option<Record>) {
    let mut parser = Parser {
        text,
        symbols,
        at: 0,
        root: Vec::new(),
        frames: Vec::new(),
        docs: Vec::new(),
        errors: Vec::new(),
        uncertain: FxHashSet::default(),
        stopped: false,
        surplus: None,
        record,
        cancellation,
    };
    if text.len() >= u32::MAX as usize {
        parser.error(SyntaxErrorKind::FileTooLarge, Span::new(0, 0));
    } else if let Some(at) = json_begins(text) {
        parser.error(SyntaxErrorKind::Json, Span::new(at as u32, at as u32 + 1));
    } else {
        parser.file();
    }
    let Parser {
        root,
        mut errors,
        uncertain,
        record,
        ..
    } = parser;
    errors.sort_by_key(|error| error.span.start);
    let parsed = Parsed {
        tree: Tree { items: root },
        errors,
        uncertain,
    };
    (parsed, record)
}

/// Returns whether pest accepts the source by the grammar's `program` rule. Later checks, such as
/// for misplaced statements, are omitted. Tests compare [`parse`] with the result.
pub fn accepts(text: &str) -> bool {
    SaParser::parse(Rule::program, text).is_ok()
}

/// Returns whether a word would be read as a unit after a value.
pub fn is_unit(word: &str) -> bool {
    SaParser::parse(Rule::unit_symbol, word).is_ok()
}
