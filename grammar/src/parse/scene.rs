//! Builds scenes and shapes: words, values and rows of cells.
use pest::Parser as _;
use pest::iterators::Pair;

use super::open_block::{OpenBlock, OpenBlockContent};
use super::parser::Parser;
use super::spans::span_of;
use super::{Rule, SaParser};
use crate::error::SyntaxErrorKind;
use crate::tree::{ItemKind, Layer, LayerRow, Quantity, Term, UnitFactor};

/// Placeholder for the value of an unreadable number. The rest of the scene does not depend on this
/// value.
const SOME_NUMBER: f64 = 1.0;

impl Parser<'_, '_> {
    pub fn scene_or_shape_piece(&mut self, pair: Pair<'_, Rule>, base: usize) {
        let span = span_of(&pair, base);
        match pair.as_rule() {
            Rule::open => self.open(OpenBlockContent::SceneBlock(Vec::new()), span),
            Rule::word => {
                let name = self.word(&pair, base);
                self.push_term(Term::Word(name));
            }
            Rule::quantity => {
                let quantity = self.quantity(pair, base);
                self.push_term(Term::Quantity(quantity));
            }
            Rule::span_of_values => self.span_of_values(pair, base),
            Rule::layer_head => self.layer_head(pair, base),
            _ => {
                let cells = pair.as_str().chars().filter(|c| !c.is_whitespace());
                let cells = cells.map(|c| c == '#').collect();
                if let Some(OpenBlockContent::Layer(layer)) =
                    self.frames.last_mut().map(|f| &mut f.content)
                {
                    layer.rows.push(LayerRow { cells, span });
                } else if !self.is_broken() {
                    self.error(
                        SyntaxErrorKind::Misplaced {
                            what: "a row of cells",
                            within: "a shape",
                            belongs: "a layer: `layer 1 { ... }`",
                            is_read: false,
                        },
                        span,
                    );
                }
            }
        }
    }

    fn layer_head(&mut self, pair: Pair<'_, Rule>, base: usize) {
        let span = span_of(&pair, base);
        let mut heights = None;
        for part in pair.into_inner() {
            if matches!(part.as_rule(), Rule::range | Rule::expr) {
                heights = Some(self.entry(part, base));
            }
        }
        let inside_shape = matches!(
            self.frames.last(),
            Some(OpenBlock { content: OpenBlockContent::Shape(item), .. }) if matches!(item.kind, ItemKind::Shape(_))
        );
        let Some(heights) = heights else { return };
        if !inside_shape && !self.is_broken() {
            self.error(
                SyntaxErrorKind::Misplaced {
                    what: "a layer",
                    within: "a layer",
                    belongs: "a shape: close the layer before it",
                    is_read: false,
                },
                span,
            );
        }
        let layer = Layer {
            heights,
            span,
            rows: Vec::new(),
        };
        self.open(OpenBlockContent::Layer(layer), span);
    }

    /// Reports a unit such as `N/m` without a number. The unexpected character is at `at`. Returns
    /// whether there is such a unit.
    pub fn lone_unit(&mut self, at: usize) -> bool {
        let content = self.frames.last_mut().map(|frame| &mut frame.content);
        let Some(OpenBlockContent::Scene(_, terms) | OpenBlockContent::SceneBlock(terms)) = content
        else {
            return false;
        };
        let Some(Term::Word(word)) = terms.last() else {
            return false;
        };
        let start = word.span.start as usize;
        let is_sign = self.text[at..].starts_with(['/', '^', '*']);
        let between = &self.text[word.span.end as usize..at];
        if !is_sign || !between.chars().all(|c| matches!(c, ' ' | '\t')) {
            return false;
        }
        let rest = super::trivia::end_of_line(self.text.as_bytes(), at);
        let written = &self.text[start..rest];
        let Ok(mut pairs) = SaParser::parse(Rule::unit, written) else {
            return false;
        };
        let Some(pair) = pairs.next().filter(|pair| start + pair.as_str().len() > at) else {
            return false;
        };
        let span = span_of(&pair, start);
        terms.pop();
        terms.push(Term::Quantity(Quantity {
            value: SOME_NUMBER,
            unit: unit(pair),
            span,
        }));
        self.error(SyntaxErrorKind::MissingNumber, span);
        self.at = span.end as usize;
        true
    }

    /// Returns whether the head of the innermost block was unreadable. This has been reported.
    fn is_broken(&self) -> bool {
        matches!(
            self.frames.last(),
            Some(OpenBlock {
                content: OpenBlockContent::Broken(_),
                ..
            })
        )
    }

    fn span_of_values(&mut self, pair: Pair<'_, Rule>, base: usize) {
        let start = span_of(&pair, base);
        let mut first = Quantity {
            value: 0.0,
            unit: Vec::new(),
            span: start,
        };
        let mut second = None;
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::number => {
                    first.span = span_of(&part, base);
                    first.value = self.number(&part, base);
                }
                Rule::unit => first.unit = unit(part),
                Rule::quantity => second = Some(self.quantity(part, base)),
                _ => {}
            }
        }
        if let Some(second) = second {
            if first.unit.is_empty() {
                first.unit.clone_from(&second.unit);
            }
            self.push_term(Term::Range(first, second));
        }
    }

    pub fn quantity(&mut self, pair: Pair<'_, Rule>, base: usize) -> Quantity {
        let span = span_of(&pair, base);
        let mut quantity = Quantity {
            value: 0.0,
            unit: Vec::new(),
            span,
        };
        for part in pair.into_inner() {
            match part.as_rule() {
                Rule::number => quantity.value = self.number(&part, base),
                _ => quantity.unit = unit(part),
            }
        }
        quantity
    }

    fn number(&mut self, pair: &Pair<'_, Rule>, base: usize) -> f64 {
        let value: f64 = pair.as_str().parse().unwrap_or(f64::INFINITY);
        if !value.is_finite() {
            self.error(SyntaxErrorKind::NumberTooLarge, span_of(pair, base));
            return SOME_NUMBER;
        }
        value
    }
}

fn unit(pair: Pair<'_, Rule>) -> Vec<UnitFactor> {
    let mut factors = Vec::new();
    let mut divides = false;
    for part in pair.into_inner() {
        if part.as_rule() == Rule::unit_operator {
            divides = part.as_str().contains('/');
            continue;
        }
        let mut symbol = String::new();
        let mut power: i8 = 1;
        for part in part.into_inner() {
            match part.as_rule() {
                Rule::unit_symbol => part.as_str().clone_into(&mut symbol),
                // Two digits at most, so it always fits.
                _ => power = part.as_str().parse().unwrap_or(1),
            }
        }
        factors.push(UnitFactor {
            symbol,
            power: if divides { -power } else { power },
        });
    }
    factors
}
