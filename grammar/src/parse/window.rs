//! Reads one sequence of pieces from a source of any size.
//!
//! pest keeps about 100 bytes per token, so it gets only a window of the source. A window may end
//! inside its last piece. That piece is left to the next window unless it must be complete.
use pest::Parser as _;
use pest::error::{Error, ErrorVariant, InputLocation};
use pest::iterators::{Pair, Pairs};

use super::open_block::Mode;
use super::{MAX_STATEMENT, Rule, SaParser, trivia, words};

pub enum Read<'t> {
    /// At least one piece. Positions are relative to the start of the window.
    Pieces(std::iter::Take<Pairs<'t, Rule>>),
    /// No piece begins here.
    Error(Unreadable),
}

/// Position and cause of an unreadable piece.
pub struct Unreadable {
    /// Position in the source where one of `expected` is valid.
    pub at: usize,
    /// Rules that were tried at this position.
    pub expected: Vec<Rule>,
    pub cause: Cause,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// A word that is not valid here.
    Word,
    /// Parentheses are nested too deep for the stack of the parser.
    Depth,
    /// A statement is longer than the largest window.
    Length,
}

/// Reads the pieces of one window that starts at `base`.
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
                    // A short piece before a long line is complete.
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
            // A limit of pest was reached in the run, which hides the pieces before it.
            Err(_) => match SaParser::parse(mode.single(), window) {
                Ok(pairs) => return Read::Pieces(pairs.take(1)),
                Err(error) => return Read::Error(unreadable(&error, base)),
            },
        }
        size = size.saturating_mul(4);
    }
}

/// Returns the end of a window, at or after `about`: after the next line end if one is near, else
/// after a space.
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

/// Returns whether the only piece of this window is complete, so that a longer window cannot extend
/// it.
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
    // The next word may continue the piece, if more of it is in the window.
    error.at > next && !is_cut_off(window, error.at, window.len())
}

/// Returns whether the end of the window may cause the error.
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

/// Returns a more precise error if an index or `after` follows a complete statement. Returns all
/// other errors unchanged.
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
