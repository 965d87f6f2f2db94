//! Reads the values of a scene.
use stochc_grammar::is_unit;
use stochc_grammar::tree::{Quantity, Term};
use stochc_ir::scene::quantity::QuantityKind;
use stochc_ir::scene::schema::{self, SchemaNumber};
use stochc_ir::scene::units::{Dimension, UNITS, converted, suggested_unit};

use stochc_grammar::Span;

use super::{ClauseContent, SceneReader, span};
use crate::diagnostic::{Code, Diagnostic, Edit, Fix, report};
use crate::expand::units::to_si;

impl<'a> SceneReader<'a, '_> {
    /// Reads the value of a scene parameter. Returns `None` and reports an error if it is wrong.
    pub(super) fn number(
        &mut self,
        number: &'static SchemaNumber,
        content: &mut ClauseContent,
    ) -> Option<()> {
        let quantity = self.quantity(number)?;
        let [value] = self.values([quantity], number)?;
        self.within(number, quantity, value)?;
        content.numbers.push((number, value));
        Some(())
    }

    /// Checks that the value of a quantity is in the range of its parameter. Reports an error and
    /// returns `None` if not.
    fn within(&mut self, number: &SchemaNumber, quantity: &Quantity, value: f64) -> Option<()> {
        let Some(rule) = number.range.violated(value) else {
            return Some(());
        };
        let location = self.location(quantity.span);
        let is_angle = number.kind.unit == QuantityKind::ANGLE.unit;
        if is_angle && quantity.unit.is_empty() && number.range.contains(value.to_radians()) {
            let help = format!("write `{} deg`", quantity.value);
            let fix = Fix::replace(location, format!("{} deg", quantity.value), help.clone());
            let diagnostic = wrong_unit(number)
                .label(location, "this value has no unit")
                .help(help)
                .fix(fix);
            report(self.diagnostics, diagnostic);
            return None;
        }
        let title = format!("`{}` is out of range", number.name());
        let diagnostic = Diagnostic::new(Code::WrongValue, title);
        let label = format!("must be {rule}");
        report(self.diagnostics, diagnostic.label(location, label));
        None
    }

    /// Reads a range: one value for both ends, or one for each. Returns `None` and reports an error
    /// if it is wrong.
    pub(super) fn range(
        &mut self,
        low: &'static SchemaNumber,
        high: &'static SchemaNumber,
        content: &mut ClauseContent,
    ) -> Option<()> {
        let Some(Term::Range(first, last)) = self.terms.peek() else {
            return self.number(high, content);
        };
        self.terms.next();
        self.place = last.span;
        let [from, to] = self.values([first, last], high)?;
        if low.range.contains(from) && from <= to {
            self.within(low, first, from)?;
            self.within(high, last, to)?;
            content.numbers.extend([(high, to), (low, from)]);
            return Some(());
        }
        let location = self.location(first.span.to(last.span));
        report(
            self.diagnostics,
            Diagnostic::new(Code::WrongValue, "the range is empty or negative").label(
                location,
                "write the smaller value first, and no value below 0",
            ),
        );
        None
    }

    fn quantity(&mut self, number: &SchemaNumber) -> Option<&'a Quantity> {
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
            let help = format!("write a number before it, such as `2 {word}`");
            let title = "a unit has no number before it".to_owned();
            self.report(
                Code::MissingTerm,
                title,
                name.span,
                "the number is missing",
                help,
            );
            return None;
        }
        let here = self.terms.peek().map_or(self.place, |term| span(term));
        let title = format!("`{}` needs {}", number.name(), number.kind.noun);
        report(
            self.diagnostics,
            Diagnostic::new(Code::MissingTerm, title)
                .label(self.location(here), "a value must stand here"),
        );
        None
    }

    /// Converts quantities to SI units. Reports wrong units. Returns `None` if a unit is wrong.
    fn values<const N: usize>(
        &mut self,
        quantities: [&Quantity; N],
        number: &SchemaNumber,
    ) -> Option<[f64; N]> {
        let kind = &number.kind;
        if quantities.iter().any(|quantity| self.is_unread(quantity)) {
            return None;
        }
        if quantities.iter().any(|quantity| lacks_unit(quantity, kind))
            && (self.unit_on_next_line(&quantities, number)
                || self.unknown_unit(&quantities, number))
        {
            return None;
        }
        let mut values = [0.0; N];
        for (value, quantity) in values.iter_mut().zip(quantities) {
            *value = self.value(quantity, number)?;
        }
        Some(values)
    }

    /// Returns whether the grammar could read only the beginning of a value. This has been reported.
    fn is_unread(&self, quantity: &Quantity) -> bool {
        let location = self.location(quantity.span);
        self.diagnostics.iter().any(|diagnostic| {
            let label = diagnostic.labels.first().map(|label| label.location);
            diagnostic.code == Code::Syntax
                && label.is_some_and(|it| {
                    it.file == location.file
                        && it.span.start == location.span.start
                        && it.span.end > location.span.end
                })
        })
    }

    fn value(&mut self, quantity: &Quantity, number: &SchemaNumber) -> Option<f64> {
        let (value, found) = to_si(quantity);
        // Zero is the same in every unit.
        if found == number.kind.dimension || value == 0.0 && quantity.unit.is_empty() {
            return Some(value);
        }
        let label = match found {
            Dimension::NUMBER => "this value has no unit".to_owned(),
            other => match other.noun() {
                "a value of another kind" => "this value has another unit".to_owned(),
                noun => format!("this is {}", noun.split(',').next().unwrap_or(noun)),
            },
        };
        let location = self.location(quantity.span);
        let mut diagnostic = wrong_unit(number).label(location, label);
        let unit = number.kind.example_unit();
        if quantity.unit.is_empty() && !unit.is_empty() {
            let help = format!("add a unit, such as `{} {unit}`", quantity.value);
            diagnostic = diagnostic.help(help);
        }
        report(self.diagnostics, diagnostic);
        None
    }

    /// Reports a unit on the line after its number, which the grammar does not read as a unit.
    /// Returns whether there is one.
    fn unit_on_next_line(&mut self, quantities: &[&Quantity], number: &SchemaNumber) -> bool {
        let mut units: Vec<&str> = Vec::new();
        let mut place: Option<Span> = None;
        while let Some(&&Term::Word(name)) = self.terms.peek()
            && is_unit(self.word_of(name))
            && !schema::is_word(self.word_of(name))
        {
            self.terms.next();
            units.push(self.word_of(name));
            place = Some(place.map_or(name.span, |place| place.to(name.span)));
        }
        let (Some(place), Some(last)) = (place, quantities.last()) else {
            return false;
        };
        let unit = units.join(" ");
        let edit = |span: Span, text: String| Edit {
            location: self.location(span),
            text,
        };
        let behind = Span::new(last.span.end, last.span.end);
        let fix = Fix {
            title: format!("write `{unit}` on the line of its number"),
            edits: vec![edit(behind, format!(" {unit}")), edit(place, String::new())],
            safe: true,
        };
        let diagnostic = wrong_unit(number)
            .label(
                self.location(place),
                "this unit is on another line than its number",
            )
            .help(format!("write `{} {unit}` on one line", last.value))
            .fix(fix);
        report(self.diagnostics, diagnostic);
        true
    }

    /// Reports an unknown word after a number. Returns whether there is one.
    fn unknown_unit(&mut self, quantities: &[&Quantity], number: &SchemaNumber) -> bool {
        let kind = &number.kind;
        let (Some(first), Some(last)) = (quantities.first(), quantities.last()) else {
            return false;
        };
        let Some(&&Term::Word(name)) = self.terms.peek() else {
            return false;
        };
        let word = self.word_of(name);
        if name.span.start > last.span.end + 1 || schema::is_word(word) {
            return false;
        }
        self.terms.next();
        let location = self.location(name.span);
        let diagnostic = wrong_unit(number).label(location, format!("`{word}` is not a unit"));
        let values: Vec<f64> = quantities.iter().map(|quantity| quantity.value).collect();
        let diagnostic = match converted(&values, word, &[*kind]) {
            Some(text) => {
                let all = self.location(first.span.to(name.span));
                let title = format!("write `{text}`");
                diagnostic
                    .help(title.clone())
                    .fix(Fix::replace(all, text, title))
            }
            None => diagnostic.suggest(location, suggested_unit(word, &[*kind]), || {
                UNITS.to_owned()
            }),
        };
        report(self.diagnostics, diagnostic);
        true
    }
}

fn lacks_unit(quantity: &Quantity, kind: &QuantityKind) -> bool {
    quantity.unit.is_empty() && kind.dimension != Dimension::NUMBER
}

fn wrong_unit(number: &SchemaNumber) -> Diagnostic {
    let title = format!("`{}` must be {}", number.name(), number.kind.noun);
    Diagnostic::new(Code::WrongDimension, title)
}
