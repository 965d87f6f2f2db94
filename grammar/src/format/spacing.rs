//! Spaces between the words of a statement or another part of a source.
use super::source::{Gap, Word};
use crate::parse::Rule;

/// Returns whether a space separates two neighbouring words. `whole` is the rule of the
/// [`TextPiece`](super::source::TextPiece) that contains them.
pub fn is_blank(whole: Rule, left: &Word<'_>, right: &Word<'_>) -> bool {
    let (Some(first), Some(second)) = (left.rule, right.rule) else {
        // The dot of a path.
        return false;
    };
    match (first, second) {
        (Rule::paren_open | Rule::bracket_open | Rule::minus, _) => false,
        (_, Rule::paren_close | Rule::bracket_close | Rule::bracket_open | Rule::comma) => false,
        // The parenthesis of a pattern's arguments has no space before it. `at (0, 0)` and `2 * (3
        // + 4)` have one.
        (Rule::name, Rule::paren_open) => false,
        (Rule::dots, _) | (_, Rule::dots) => whole == Rule::span_of_values,
        // `20cm` and `20 cm` are both good.
        (Rule::number, Rule::unit) => right.gap != Gap::None,
        _ => true,
    }
}

/// Counter of the open parentheses of a piece. Lines break only outside of parentheses.
#[derive(Debug, Default)]
pub struct Breaks {
    parens: u32,
    brackets: u32,
}

impl Breaks {
    /// Counts the parentheses of a word. Returns whether the line may break before the next word.
    pub fn may_break(&mut self, whole: Rule, word: &Word<'_>, next: &Word<'_>) -> bool {
        match word.rule {
            Some(Rule::paren_open) => self.parens += 1,
            Some(Rule::paren_close) => self.parens = self.parens.saturating_sub(1),
            Some(Rule::bracket_open) => self.brackets += 1,
            Some(Rule::bracket_close) => self.brackets = self.brackets.saturating_sub(1),
            _ => {}
        }
        // Positions and indices stay on one line. Lists of arguments may break.
        let listed = u32::from(matches!(
            whole,
            Rule::instance | Rule::pattern_head | Rule::assembly_head
        ));
        if self.brackets > 0 || self.parens > listed {
            return false;
        }
        word.rule == Some(Rule::comma)
            || matches!(
                next.rule,
                Some(Rule::arrow | Rule::kw_after | Rule::kw_as | Rule::kw_with)
            )
    }
}
