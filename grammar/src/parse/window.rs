//! One run of pieces out of a text of any size.
//!
//! Pest keeps some 100 bytes for every token it has seen, so it is given a window of the text. A
//! window may cut a piece in two, but only the last piece it holds: that one is left to the next
//! window, unless nothing can be missing of it.
use pest::Parser as _;
use pest::error::{Error, ErrorVariant, InputLocation};
use pest::iterators::{Pair, Pairs};

use super::frame::Mode;
use super::{MAX_STATEMENT, Rule, SaParser, trivia, words};

/// What a window gave.
pub enum Read<'t> {
    /// Pieces, at least one; their positions are relative to the window.
    Pieces(std::iter::Take<Pairs<'t, Rule>>),
    /// No piece can begin here.
    Error(Unreadable),
}

/// No piece could be read.
pub struct Unreadable {
    /// The byte at which the words in `expected` could have stood.
    pub at: usize,
    /// Rules that were tried there.
    pub expected: Vec<Rule>,
    /// Why, if not for a wrong word.
    pub cause: Cause,
}

/// Why no piece could be read.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// A wrong word.
    Word,
    /// Parentheses nested beyond the parser's stack.
    Depth,
    /// A statement longer than the largest window.
    Length,
}

/// Reads the pieces from `base` on, as many as a window holds.
pub fn read(text: &str, base: usize, mode: Mode) -> Read<'_> {
    let mut size = mode.window();
    loop {
        let end = cut(text, base.saturating_add(size));
        let window = &text[base..end];
        let whole = end == text.len();
        match SaParser::parse(mode.run(), window) {
            Ok(pairs) => {
                let count = pairs.len();
                if whole && count > 0 {
                    return Read::Pieces(pairs.take(count));
                }
                if count > 1 {
                    return Read::Pieces(pairs.take(count - 1));
                }
                if pairs
                    .peek()
                    .is_some_and(|only| is_complete(&only, window, mode))
                {
                    return Read::Pieces(pairs.take(1));
                }
                if count == 0 {
                    let error = explain(window, base, mode);
                    if whole || !is_cut_off(text, error.at, end) || size > MAX_STATEMENT {
                        return Read::Error(error);
                    }
                } else if size > MAX_STATEMENT {
                    // A short piece with a long line behind it is no long piece.
                    let end = pairs.peek().map_or(0, |only| only.as_span().end());
                    if end <= window.len() / 2 {
                        return Read::Pieces(pairs.take(1));
                    }
                    return Read::Error(Unreadable {
                        at: base,
                        expected: Vec::new(),
                        cause: Cause::Length,
                    });
                }
            }
            // A limit of pest's was reached somewhere in the run: it hides the pieces before it.
            Err(_) => match SaParser::parse(mode.single(), window) {
                Ok(pairs) => return Read::Pieces(pairs.take(1)),
                Err(error) => return Read::Error(unreadable(&error, base)),
            },
        }
        size = size.saturating_mul(4);
    }
}

/// Where a window of about this end may be cut: behind a newline, else behind a blank.
pub fn cut(text: &str, about: usize) -> usize {
    const FAR: usize = 1 << 16;
    if about >= text.len() {
        return text.len();
    }
    let rest = &text.as_bytes()[about..];
    let near = &rest[..rest.len().min(FAR)];
    let offset = (near.iter().position(|&byte| byte == b'\n'))
        .or_else(|| near.iter().position(|&byte| byte == b' '));
    let mut end = about + offset.map_or(near.len(), |offset| offset + 1);
    while !text.is_char_boundary(end) {
        end += 1;
    }
    end
}

/// Whether a longer window could not make more of the only piece of this one.
fn is_complete(piece: &Pair<'_, Rule>, window: &str, mode: Mode) -> bool {
    let end = piece.as_span().end();
    if window[..end].ends_with(['{', '}']) {
        return true;
    }
    let next = trivia::skip(window, end);
    if next == window.len() {
        return false;
    }
    let error = explain(&window[next..], next, mode);
    // What begins no piece may go on with this one, if more of it can be seen.
    error.at > next && !is_cut_off(window, error.at, window.len())
}

/// Whether an error may be due to the end of the window rather than to the text.
fn is_cut_off(text: &str, at: usize, end: usize) -> bool {
    !text.as_bytes()[at..end].contains(&b'\n') || trivia::skip(&text[..end], at) == end
}

fn explain(window: &str, base: usize, mode: Mode) -> Unreadable {
    match SaParser::parse(mode.single(), window) {
        Ok(pairs) => Unreadable {
            at: base + pairs.last().map_or(0, |pair| pair.as_span().end()),
            expected: Vec::new(),
            cause: Cause::Word,
        },
        Err(error) => unreadable(&error, base),
    }
}

/// What is wrong with an index or an `after` that follows a statement: without it, that is whole.
pub fn sharpen(text: &str, base: usize, error: Unreadable) -> Unreadable {
    const MAX: usize = 1 << 12;
    let window = &text[base..cut(text, base.saturating_add(MAX))];
    let rule = if window.starts_with('[') {
        Rule::index
    } else if words::found(text, base) == "after" {
        Rule::after
    } else {
        return error;
    };
    match SaParser::parse(rule, window) {
        Err(inner) if error.cause == Cause::Word => unreadable(&inner, base),
        _ => error,
    }
}

fn unreadable(error: &Error<Rule>, base: usize) -> Unreadable {
    let at = base
        + match error.location {
            InputLocation::Pos(at) | InputLocation::Span((at, _)) => at,
        };
    match &error.variant {
        ErrorVariant::ParsingError { positives, .. } => Unreadable {
            at,
            expected: positives.clone(),
            cause: Cause::Word,
        },
        ErrorVariant::CustomError { .. } => Unreadable {
            at,
            expected: Vec::new(),
            cause: Cause::Depth,
        },
    }
}
