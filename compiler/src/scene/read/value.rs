//! The values of a scene.
use stochc_grammar::is_unit;
use stochc_grammar::tree::{Quantity, Term};
use stochc_ir::scene::schema::{self, SchemaNumber};
use stochc_ir::scene::units::{Dimension, UNITS, unit_meant};

use super::{ClauseContent, SceneReader, span};
use crate::diagnostic::{Code, Diagnostic, report};
use crate::units::to_si;

impl<'a> SceneReader<'a, '_> {
    /// A value for a number.
    pub(super) fn number(
        &mut self,
        number: &'static SchemaNumber,
        said: &mut ClauseContent,
    ) -> Option<()> {
        let quantity = self.quantity(number.kind.dimension)?;
        let value = self.value(quantity, number.kind.dimension)?;
        self.within(number, quantity, value)?;
        said.numbers.push((number, value));
        Some(())
    }

    /// `None`, and a diagnostic: the value of a quantity is out of the range of a number.
    fn within(&mut self, number: &SchemaNumber, quantity: &Quantity, value: f64) -> Option<()> {
        let Some(rule) = number.range.violated(value) else {
            return Some(());
        };
        let location = self.location(quantity.span);
        let diagnostic = Diagnostic::new(Code::WrongValue, "a value out of its range");
        let label = format!("must be {rule}");
        report(self.diagnostics, diagnostic.label(location, label));
        None
    }

    /// A value for both ends of a range, or one for each.
    pub(super) fn range(
        &mut self,
        low: &'static SchemaNumber,
        high: &'static SchemaNumber,
        said: &mut ClauseContent,
    ) -> Option<()> {
        let Some(Term::Range(first, last)) = self.terms.peek() else {
            return self.number(high, said);
        };
        self.terms.next();
        self.place = last.span;
        let dimension = high.kind.dimension;
        let (from, to) = (self.value(first, dimension)?, self.value(last, dimension)?);
        if low.range.contains(from) && from <= to {
            self.within(low, first, from)?;
            self.within(high, last, to)?;
            said.numbers.extend([(high, to), (low, from)]);
            return Some(());
        }
        let location = self.location(first.span.to(last.span));
        report(
            self.diagnostics,
            Diagnostic::new(Code::WrongValue, "a range that is empty or negative")
                .label(location, "from small to large, and not below 0"),
        );
        None
    }

    fn quantity(&mut self, dimension: Dimension) -> Option<&'a Quantity> {
        if let Some(Term::Quantity(quantity)) = self.terms.peek() {
            self.terms.next();
            self.place = quantity.span;
            return Some(quantity);
        }
        if let Some(&&Term::Word(name)) = self.terms.peek()
            && !schema::is_word(self.word_of(name))
            && is_unit(self.word_of(name))
        {
            self.terms.next();
            let word = self.word_of(name);
            let help = format!("write the number before it, such as `2 {word}`");
            let title = "a unit without its number".to_owned();
            self.report(Code::MissingTerm, title, name.span, "how much?", help);
            return None;
        }
        let here = self.terms.peek().map_or(self.place, |term| span(term));
        let title = format!("expected {}", dimension.noun());
        report(
            self.diagnostics,
            Diagnostic::new(Code::MissingTerm, title)
                .label(self.location(here), "a value belongs here"),
        );
        None
    }

    fn value(&mut self, quantity: &Quantity, dimension: Dimension) -> Option<f64> {
        let (value, found) = to_si(quantity);
        if found == dimension {
            return Some(value);
        }
        let title = format!("expected {}", dimension.noun());
        if let (Dimension::NUMBER, Some(&&Term::Word(name))) = (found, self.terms.peek())
            && name.span.start <= quantity.span.end + 1
            && !schema::is_word(self.word_of(name))
        {
            self.terms.next();
            let word = self.word_of(name);
            let location = self.location(name.span);
            let diagnostic = Diagnostic::new(Code::WrongDimension, title)
                .label(location, format!("`{word}` is no unit"))
                .suggest(location, unit_meant(word), || UNITS.to_owned());
            report(self.diagnostics, diagnostic);
            return None;
        }
        let label = match found {
            Dimension::NUMBER => "has no unit".to_owned(),
            other => match other.noun() {
                "a value of another kind" => "has another unit".to_owned(),
                noun => format!("is {}", noun.split(',').next().unwrap_or(noun)),
            },
        };
        let location = self.location(quantity.span);
        report(
            self.diagnostics,
            Diagnostic::new(Code::WrongDimension, title).label(location, label),
        );
        None
    }
}
