//! Tokens of a file, for the formatter.
use pest::iterators::Pair;

use super::Rule;
use super::spans::span_of;
use crate::Span;

/// Every token of a file, in order.
#[derive(Debug, Default)]
pub(crate) struct Record {
    pub tokens: Vec<Token>,
    /// Rule and first token of each piece, such as a statement, the head of a block or a closing
    /// brace.
    pub pieces: Vec<(Rule, u32)>,
}

/// A word, sign or value.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Token {
    pub rule: Rule,
    pub span: Span,
}

impl Record {
    /// Adds the tokens of a piece. The dots of qualified names have no rule and are not recorded.
    pub fn piece(&mut self, pair: &Pair<'_, Rule>, base: usize) {
        let first = self.tokens.len() as u32;
        self.pieces.push((pair.as_rule(), first));
        // A value and its unit belong together, whatever they consist of.
        let mut whole_until = 0;
        for part in std::iter::once(pair.clone()).chain(pair.clone().into_inner().flatten()) {
            let span = span_of(&part, base);
            if span.is_empty() || span.end <= whole_until {
                continue;
            }
            let rule = part.as_rule();
            if matches!(rule, Rule::quantity | Rule::time | Rule::unit) {
                whole_until = span.end;
            } else if part.into_inner().next().is_some() {
                continue;
            }
            self.tokens.push(Token { rule, span });
        }
    }
}
