//! Spans of pest's pairs.
use pest::iterators::Pair;

use super::grammar::Rule;
use crate::Span;

/// Returns the end of the last word. Excludes space and comments before an absent optional part.
pub(super) fn end_of(pair: &Pair<'_, Rule>, base: usize) -> u32 {
    let mut last = pair.clone();
    while let Some(inner) = last.clone().into_inner().next_back() {
        last = inner;
    }
    span_of(&last, base).end
}

pub(super) fn span_of(pair: &Pair<'_, Rule>, base: usize) -> Span {
    let span = pair.as_span();
    Span::new((base + span.start()) as u32, (base + span.end()) as u32)
}
