//! Divides a source into [pieces](TextPiece), words and comments.
use std::borrow::Cow;
use std::ops::Range;

use crate::parse::{Record, Rule, Token, is_comment};

/// A source divided into pieces, words and comments.
pub struct TokenizedText<'t> {
    pub pieces: Vec<TextPiece>,
    pub words: Vec<Word<'t>>,
    pub notes: Vec<Note<'t>>,
    /// Indices of the comments after the last piece.
    pub rest: Range<usize>,
}

/// A part of the source: a statement, the head of a block, a brace, or a row of cells.
#[derive(Clone, Debug)]
pub struct TextPiece {
    pub rule: Rule,
    /// Indices of the words. Comments before the piece belong to the first word.
    pub words: Range<usize>,
}

/// A token with its surroundings.
#[derive(Clone, Debug)]
pub struct Word<'t> {
    /// Grammar rule of the token. `None` for the dot of a qualified name.
    pub rule: Option<Rule>,
    text: &'t str,
    /// Indices of the comments before the token.
    pub notes: Range<usize>,
    /// Number of line breaks between the token and the previous one or its comments.
    pub newlines: u32,
    /// Space between the token and the previous one on the same line.
    pub gap: Gap,
}

/// Space between two words on one line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gap {
    None,
    Blank,
    Wide,
}

#[derive(Clone, Debug)]
pub struct Note<'t> {
    /// Text of the comment with its slashes, without trailing space.
    pub text: &'t str,
    /// Number of line breaks directly before the comment. 0 if the comment follows code on the same
    /// line.
    pub newlines: u32,
    /// Column of the comment, from 0.
    pub column: usize,
}

impl<'t> Word<'t> {
    /// Returns the token as written, with at most one space between a value and its unit.
    pub fn text(&self) -> Cow<'t, str> {
        match self.rule {
            Some(Rule::quantity | Rule::time | Rule::unit)
                if self.text.contains("  ") || self.text.contains('\t') =>
            {
                let parts = self.text.split_ascii_whitespace();
                parts.collect::<Vec<_>>().join(" ").into()
            }
            Some(Rule::doc) => self.text.trim_end().into(),
            _ => self.text.into(),
        }
    }
}

impl TokenizedText<'_> {
    /// Returns the first word of a piece. The comments before the piece belong to it.
    pub fn first(&self, piece: &TextPiece) -> &Word<'_> {
        &self.words[piece.words.start]
    }

    /// Returns whether a comment is inside a piece.
    pub fn is_commented(&self, piece: &TextPiece) -> bool {
        let inner = piece.words.start + 1..piece.words.end;
        self.words[inner].iter().any(|word| !word.notes.is_empty())
    }
}

/// Divides a source into pieces, words and comments.
pub fn read<'t>(text: &'t str, record: &Record) -> TokenizedText<'t> {
    let mut reader = TokenReader {
        text,
        at: 0,
        words: Vec::with_capacity(record.tokens.len()),
        notes: Vec::new(),
    };
    let mut pieces = Vec::with_capacity(record.pieces.len());
    for (i, &(rule, first)) in record.pieces.iter().enumerate() {
        let end = (record.pieces.get(i + 1)).map_or(record.tokens.len(), |next| next.1 as usize);
        let start = reader.words.len();
        for token in &record.tokens[first as usize..end] {
            reader.token(token);
        }
        let words = start..reader.words.len();
        if !words.is_empty() {
            pieces.push(TextPiece { rule, words });
        }
    }
    let before = reader.notes.len();
    reader.between(text.len());
    TokenizedText {
        pieces,
        rest: before..reader.notes.len(),
        words: reader.words,
        notes: reader.notes,
    }
}

struct TokenReader<'t> {
    text: &'t str,
    at: usize,
    words: Vec<Word<'t>>,
    notes: Vec<Note<'t>>,
}

impl<'t> TokenReader<'t> {
    fn token(&mut self, token: &Token) {
        let (start, end) = (token.span.start as usize, token.span.end as usize);
        let first = self.notes.len();
        let mut newlines = self.between(start);
        let mut gap = self.gap_before(start);
        // The source between two names of a path is a dot.
        if self.at < start {
            let at = self.at;
            self.at += 1;
            self.push(None, at..at + 1, first, newlines, gap);
            newlines = self.between(start);
            gap = Gap::None;
        }
        let first = first.max(self.words.last().map_or(0, |word| word.notes.end));
        self.push(Some(token.rule), start..end, first, newlines, gap);
        self.at = end;
    }

    fn push(
        &mut self,
        rule: Option<Rule>,
        span: Range<usize>,
        first_note: usize,
        newlines: u32,
        gap: Gap,
    ) {
        self.words.push(Word {
            rule,
            text: &self.text[span],
            notes: first_note..self.notes.len(),
            newlines,
            gap,
        });
    }

    fn gap_before(&self, start: usize) -> Gap {
        let blanks = self.text[..start].bytes().rev();
        match blanks
            .take(2)
            .take_while(|byte| b" \t".contains(byte))
            .count()
        {
            0 => Gap::None,
            1 if self.text.as_bytes()[start - 1] == b' ' => Gap::Blank,
            _ => Gap::Wide,
        }
    }

    /// Skips space and comments up to `end` or to code. Returns the number of line ends after the
    /// last comment.
    fn between(&mut self, end: usize) -> u32 {
        let bytes = self.text.as_bytes();
        let mut newlines = 0;
        while self.at < end {
            match bytes[self.at] {
                b'\n' => newlines += 1,
                b' ' | b'\t' | b'\r' => {}
                _ if is_comment(&bytes[self.at..]) => {
                    self.note(end, newlines);
                    newlines = 0;
                    continue;
                }
                _ => break,
            }
            self.at += 1;
        }
        newlines
    }

    fn note(&mut self, end: usize, newlines: u32) {
        let text = &self.text[self.at..end];
        let text = text.split('\n').next().unwrap_or(text);
        let line = self.text[..self.at].rfind('\n').map_or(0, |at| at + 1);
        self.notes.push(Note {
            text: text.trim_end(),
            newlines,
            column: self.text[line..self.at].chars().count(),
        });
        self.at += text.len();
    }
}
