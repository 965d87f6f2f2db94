//! Parses a source, one sequence of pieces at a time.
mod brace;
mod build;
mod expr;
mod frame;
mod record;
mod recover;
mod scene;
mod trivia;
mod window;
mod words;

use pest::Parser as _;
use pest::iterators::Pair;
use rustc_hash::FxHashSet;

use crate::error::{SyntaxError, SyntaxErrorKind};
use crate::tree::{Docs, Item, Tree};
use crate::{Cancellation, Cancelled, Span, Symbol, Symbols};
use frame::{Mode, OpenBlock};
pub(crate) use record::{Record, Token};
pub use trivia::is_comment;

pub(crate) use grammar::{Rule, SaParser};

#[allow(missing_docs, reason = "pest derives an undocumented enum of rules")]
mod grammar {
    #[derive(pest_derive::Parser)]
    #[grammar = "sa.pest"]
    pub(crate) struct SaParser;
}

/// Largest depth of blocks, and of parentheses.
pub const MAX_DEPTH: usize = 100;

/// Largest number of numbers and names in an expression. Their sum is computed recursively.
pub const MAX_TERMS: usize = 1_000;

/// Largest number of bytes of a statement.
pub const MAX_STATEMENT: usize = 4 << 20;

/// Largest number of errors that are reported for a file.
pub const MAX_ERRORS: usize = 100;

/// Result of parsing a file.
#[derive(Clone, Debug)]
pub struct Parsed {
    /// Everything that could be read.
    pub tree: Tree,
    /// Errors in source order.
    pub errors: Vec<SyntaxError>,
    /// Words of skipped parts. They cause no errors of unknown names.
    pub doubtful: FxHashSet<Symbol>,
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

/// Returns the start of a file that is JSON. A program never begins with a bracket and a quotation
/// mark or another bracket.
fn json_begins(text: &str) -> Option<usize> {
    let begun = text.trim_start();
    let inside = begun.strip_prefix(['{', '['])?.trim_start();
    (inside.starts_with(['"', '{', '['])).then(|| text.len() - begun.len())
}

fn read<'t>(
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
        doubtful: FxHashSet::default(),
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
        doubtful,
        record,
        ..
    } = parser;
    errors.sort_by_key(|error| error.span.start);
    let parsed = Parsed {
        tree: Tree { items: root },
        errors,
        doubtful,
    };
    (parsed, record)
}

/// Returns whether pest accepts the source by the grammar's `program` rule, without checks of
/// surroundings. Tests compare [`parse`] with it.
pub fn accepts(text: &str) -> bool {
    SaParser::parse(Rule::program, text).is_ok()
}

/// Returns whether a word would be read as a unit after a value.
pub fn is_unit(word: &str) -> bool {
    SaParser::parse(Rule::unit_symbol, word).is_ok()
}

struct Parser<'t, 's> {
    text: &'t str,
    symbols: &'s mut Symbols,
    /// Position of the first unread byte.
    at: usize,
    root: Vec<Item>,
    /// Open blocks, the outermost first.
    frames: Vec<OpenBlock>,
    /// Comments that document the next item.
    docs: Vec<(String, Span)>,
    errors: Vec<SyntaxError>,
    doubtful: FxHashSet<Symbol>,
    /// Whether the rest of the file is skipped.
    stopped: bool,
    /// Number of closing braces without an opening one. `None` before they are counted.
    surplus: Option<i64>,
    /// Every token, if requested.
    record: Option<Record>,
    cancellation: Cancellation<'t>,
}

impl Parser<'_, '_> {
    fn file(&mut self) {
        while !self.stopped && !self.cancellation.is_cancelled() {
            self.at = trivia::skip(self.text, self.at);
            if self.at == self.text.len() {
                break;
            }
            if self.errors.len() >= MAX_ERRORS {
                let here = self.at as u32;
                self.errors.push(SyntaxError {
                    kind: SyntaxErrorKind::TooMany,
                    span: Span::new(here, here),
                });
                self.stop();
                break;
            }
            self.run();
        }
        self.dangling_docs();
        while let Some(frame) = self.frames.pop() {
            if !self.stopped {
                self.error(SyntaxErrorKind::Unclosed, frame.opened);
            }
            self.finish(frame, self.text.len() as u32);
        }
    }

    /// Skips the rest of the file.
    fn stop(&mut self) {
        self.stopped = true;
        self.doubt(self.at, self.text.len());
        self.at = self.text.len();
    }

    /// Reads one sequence of pieces, or one error.
    fn run(&mut self) {
        let mode = self.mode();
        let base = self.at;
        match window::read(self.text, base, mode) {
            window::Read::Pieces(pairs) => self.pieces(pairs, base, mode),
            window::Read::Error(error) => self.recover(error),
        }
    }

    fn pieces<'i>(&mut self, pairs: impl Iterator<Item = Pair<'i, Rule>>, base: usize, mode: Mode) {
        for pair in pairs {
            let end = base + pair.as_span().end();
            self.at = end;
            self.piece(pair, base);
            // The rest of the sequence was read with the rules of a closed block.
            if self.mode() != mode || self.stopped {
                return;
            }
        }
    }

    fn piece(&mut self, pair: Pair<'_, Rule>, base: usize) {
        let span = span_of(&pair, base);
        if let Some(record) = &mut self.record {
            record.piece(&pair, base);
        }
        match pair.as_rule() {
            Rule::doc => {
                let line = pair.as_str()[3..].trim().to_owned();
                self.docs.push((line, span));
            }
            Rule::close => self.close(span),
            _ => self.build(pair, base),
        }
    }

    fn mode(&self) -> Mode {
        self.frames.last().map_or(Mode::Block, |frame| frame.mode())
    }

    fn error(&mut self, kind: SyntaxErrorKind, span: Span) {
        if self.errors.len() < MAX_ERRORS {
            self.errors.push(SyntaxError { kind, span });
        }
    }

    fn take_docs(&mut self) -> Docs {
        if self.docs.is_empty() {
            return Docs(None);
        }
        let lines = self.docs.drain(..).map(|(line, _)| line).collect();
        Docs(Some(Box::new(lines)))
    }

    fn dangling_docs(&mut self) {
        if let Some((_, first)) = self.docs.first() {
            let span = *first;
            self.docs.clear();
            self.error(SyntaxErrorKind::DanglingDoc, span);
        }
    }
}

/// Returns the end of the last word, excluding space and comments before an absent optional part.
fn end_of(pair: &Pair<'_, Rule>, base: usize) -> u32 {
    let mut last = pair.clone();
    while let Some(inner) = last.clone().into_inner().next_back() {
        last = inner;
    }
    span_of(&last, base).end
}

fn span_of(pair: &Pair<'_, Rule>, base: usize) -> Span {
    let span = pair.as_span();
    Span::new((base + span.start()) as u32, (base + span.end()) as u32)
}
