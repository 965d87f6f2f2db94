//! State of the parser of a file.
use pest::iterators::Pair;
use rustc_hash::FxHashSet;

use super::grammar::Rule;
use super::limits::MAX_ERRORS;
use super::open_block::{Mode, OpenBlock};
use super::record::Record;
use super::spans::span_of;
use super::{trivia, window};
use crate::error::{SyntaxError, SyntaxErrorKind};
use crate::tree::{Docs, Item};
use crate::{Cancellation, Span, Symbol, Symbols};

pub(super) struct Parser<'t, 's> {
    pub(super) text: &'t str,
    pub(super) symbols: &'s mut Symbols,
    /// Position of the first unread byte.
    pub(super) at: usize,
    pub(super) root: Vec<Item>,
    /// Open blocks, the outermost first.
    pub(super) frames: Vec<OpenBlock>,
    /// Comments that document the next item.
    pub(super) docs: Vec<(String, Span)>,
    pub(super) errors: Vec<SyntaxError>,
    pub(super) uncertain: FxHashSet<Symbol>,
    /// Whether the rest of the file is skipped.
    pub(super) stopped: bool,
    /// Number of closing braces without an opening one. `None` before they are counted.
    pub(super) surplus: Option<i64>,
    /// Every token, if requested.
    pub(super) record: Option<Record>,
    pub(super) cancellation: Cancellation<'t>,
}

impl Parser<'_, '_> {
    pub(super) fn file(&mut self) {
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
    pub(super) fn stop(&mut self) {
        self.stopped = true;
        self.mark_uncertain(self.at, self.text.len());
        self.at = self.text.len();
    }

    /// Reads one sequence of pieces, or one error.
    pub(super) fn run(&mut self) {
        let mode = self.mode();
        let base = self.at;
        match window::read(self.text, base, mode) {
            window::Read::Pieces(pairs) => self.pieces(pairs, base, mode),
            window::Read::Error(error) => self.recover(error),
        }
    }

    pub(super) fn pieces<'i>(
        &mut self,
        pairs: impl Iterator<Item = Pair<'i, Rule>>,
        base: usize,
        mode: Mode,
    ) {
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

    pub(super) fn piece(&mut self, pair: Pair<'_, Rule>, base: usize) {
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

    pub(super) fn mode(&self) -> Mode {
        self.frames.last().map_or(Mode::Block, |frame| frame.mode())
    }

    pub(super) fn error(&mut self, kind: SyntaxErrorKind, span: Span) {
        if self.errors.len() < MAX_ERRORS {
            self.errors.push(SyntaxError { kind, span });
        }
    }

    pub(super) fn take_docs(&mut self) -> Docs {
        if self.docs.is_empty() {
            return Docs(None);
        }
        let lines = self.docs.drain(..).map(|(line, _)| line).collect();
        Docs(Some(Box::new(lines)))
    }

    pub(super) fn dangling_docs(&mut self) {
        if let Some((_, first)) = self.docs.first() {
            let span = *first;
            self.docs.clear();
            self.error(SyntaxErrorKind::DanglingDoc, span);
        }
    }
}
