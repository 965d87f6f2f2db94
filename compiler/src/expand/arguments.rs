//! Checks the arguments of patterns.
use stochc_grammar::Span;
use stochc_grammar::tree::{Argument, Expr, ExprKind, Instance, Name, Pattern, Place};
use stochc_text::suggest::nearest;

use super::expander::Expander;
use super::place::suggested_face;
use super::scope::BoundValue;
use super::uses::Uses;
use crate::diagnostic::{Code, Diagnostic, Edit, Fix};
use crate::expanded::{NameKey, PatternInstance};
use crate::names::ValueKind;
use crate::{FileId, SourceLocation};

/// An argument whose kind differs from the required kind.
struct Misfit {
    /// Index of the argument.
    number: usize,
    /// Kind of the argument.
    given: ValueKind,
    /// Required kind, and the location of the use that requires it.
    needed: (ValueKind, SourceLocation),
}

impl<'a> Expander<'a, '_> {
    /// Returns the values of the arguments of an instance. Reports arguments of the wrong kind and
    /// makes them unknown.
    pub(super) fn arguments(
        &mut self,
        instance: &'a Instance,
        (file, pattern): (FileId, &'a Pattern),
    ) -> Vec<BoundValue> {
        self.steps = self.steps.saturating_add(instance.arguments.len());
        let mut values: Vec<BoundValue> = (instance.arguments.iter())
            .map(|argument| self.argument(argument))
            .collect();
        let uses = (self.known).uses((file, pattern), &self.declared.patterns, self.names);
        let misfits: Vec<Misfit> = (values.iter().zip(&*uses).enumerate())
            .filter_map(|(number, (&value, uses))| {
                let (given, needed) = (value.kind()?, uses.only()?);
                (given != needed.0).then_some(Misfit {
                    number,
                    given,
                    needed,
                })
            })
            .collect();
        if misfits.is_empty() {
            return values;
        }
        if let Some(order) = right_order(&misfits, &values, &uses) {
            let diagnostic = self.wrong_order(instance, pattern, &misfits, &order);
            self.diagnostics.push(diagnostic);
        } else {
            for misfit in &misfits {
                self.misfit(instance, pattern, misfit, values[misfit.number]);
            }
        }
        for misfit in &misfits {
            values[misfit.number] = BoundValue::Unknown;
        }
        values
    }

    pub(super) fn note_instance(
        &mut self,
        scope: u32,
        instance: &Instance,
        span: Span,
        (file, pattern): (FileId, &Pattern),
        is_uncertain: bool,
    ) {
        let grown = &mut self.plan.grown;
        if let Some(known) = grown.get_mut(scope as usize - 1) {
            known.is_uncertain |= is_uncertain;
            return;
        }
        let end = (instance.alias.as_ref()).map_or(span.end, |alias| alias.span.start);
        grown.push(PatternInstance {
            pattern: pattern.name.symbol,
            declared: SourceLocation {
                file,
                span: pattern.name.span,
            },
            call: SourceLocation {
                file: self.file,
                span: Span::new(span.start, end),
            },
            is_uncertain,
        });
    }

    fn argument(&mut self, argument: &'a Argument) -> BoundValue {
        match argument {
            Argument::Place(place) => {
                if let (Some((face, _)), true) = (place.face, place.path.is_empty()) {
                    return BoundValue::Face(face);
                }
                if let Some((_, span)) = place.face {
                    self.diagnostics.push(
                        Diagnostic::new(
                            Code::FaceMisused,
                            "an argument is a block or a face, not both",
                        )
                        .label(self.location(span), "a face after a block")
                        .help("write two arguments, such as `A, up`"),
                    );
                    return BoundValue::Unknown;
                }
                self.single_block(place)
            }
            Argument::Expr(expr) => {
                // A bare name is a number, a face or a block.
                if let ExprKind::Name(word) = expr.kind {
                    let name = Name {
                        symbol: word,
                        span: expr.span,
                    };
                    let value = self.value(name).unwrap_or(BoundValue::Block(NameKey {
                        scope: self.scope.instance,
                        word,
                        arity: 0,
                        index: [0; NameKey::MAX_INDICES],
                    }));
                    if let BoundValue::Block(key) = value {
                        self.probe
                            .note_span(self.file, expr.span, [key].into_iter());
                    }
                    return value;
                }
                self.evaluate(expr)
                    .map_or(BoundValue::Unknown, BoundValue::Number)
            }
        }
    }

    fn single_block(&mut self, place: &'a Place) -> BoundValue {
        let Some((key, _)) =
            self.single(place, "pass one block, or use the pattern in a loop", None)
        else {
            return BoundValue::Unknown;
        };
        self.role(key);
        BoundValue::Block(key)
    }

    fn misfit(
        &mut self,
        instance: &'a Instance,
        pattern: &'a Pattern,
        misfit: &Misfit,
        value: BoundValue,
    ) {
        let argument = &instance.arguments[misfit.number];
        let (needed, used) = misfit.needed;
        let location = self.location(span_of(argument));
        let name = |symbol| self.symbols.word(symbol);
        let parameter = pattern.parameters[misfit.number];
        let label = format!(
            "`{}` is used as {} here",
            name(parameter.symbol),
            needed.noun()
        );
        // An unknown bare name was taken for a block.
        let unknown = match (argument, value) {
            (Argument::Expr(expr), BoundValue::Block(key))
                if self.plan.roles.get(&key).is_none()
                    && self.names.definition(self.file, expr.span).is_none() =>
            {
                Some((expr, key.word))
            }
            _ => None,
        };
        match (needed, unknown) {
            (ValueKind::Number, Some((expr, _))) => {
                let reported = self.diagnostics.len();
                self.evaluate(expr);
                for diagnostic in &mut self.diagnostics[reported..] {
                    *diagnostic = diagnostic.clone().label(used, label.clone());
                }
                return;
            }
            (ValueKind::Face, Some((_, word))) => {
                let word = name(word);
                let suggestion = suggested_face(word)
                    .or_else(|| nearest(word, stochc_ir::Face::ALL.map(|face| face.word())));
                if suggestion.is_some() {
                    let diagnostic =
                        Diagnostic::about(Code::UnknownName, "`{}` is not a face", &[word])
                            .label(location, "unknown face")
                            .label(used, label)
                            .suggest(location, suggestion, String::new);
                    self.diagnostics.push(diagnostic);
                    return;
                }
            }
            _ => {}
        }
        let title = format!(
            "`{}` of `{}` is {}, not {}",
            name(parameter.symbol),
            name(pattern.name.symbol),
            needed.noun(),
            misfit.given.noun(),
        );
        let help = match needed {
            ValueKind::Block => "pass the name of a seed or of a captured block",
            ValueKind::Number => "pass a whole number, or the name of a `let`",
            ValueKind::Face => "pass up, down, north, south, east or west",
        };
        let diagnostic = Diagnostic::new(Code::WrongKind, title)
            .label(location, format!("this is {}", misfit.given.noun()))
            .label(used, label)
            .help(help);
        self.diagnostics.push(self.in_instance(diagnostic));
    }

    /// Reports arguments in the wrong order. Each entry of `order` contains the index of a
    /// parameter and the index of its right argument.
    fn wrong_order(
        &self,
        instance: &Instance,
        pattern: &Pattern,
        misfits: &[Misfit],
        order: &[(usize, usize)],
    ) -> Diagnostic {
        let word = self.symbols.word(pattern.name.symbol);
        let location = |number: usize| self.location(span_of(&instance.arguments[number]));
        let title = match order.len() {
            2 => format!("two arguments of `{word}` are swapped"),
            _ => format!("the arguments of `{word}` are in the wrong order"),
        };
        let mut diagnostic = Diagnostic::new(Code::WrongKind, title);
        for misfit in misfits {
            let parameter = self.symbols.word(pattern.parameters[misfit.number].symbol);
            let (given, needed) = (misfit.given.noun(), misfit.needed.0.noun());
            let text = format!("{given}, and `{parameter}` is {needed}");
            diagnostic = diagnostic.label(location(misfit.number), text);
        }
        for misfit in misfits {
            let text = format!("used as {} here", misfit.needed.0.noun());
            diagnostic = diagnostic.label(misfit.needed.1, text);
        }
        let mut texts: Vec<&str> = (0..instance.arguments.len())
            .map(|number| self.sources.text(location(number)))
            .collect();
        let old = texts.clone();
        let edits = order.iter().map(|&(number, from)| {
            texts[number] = old[from];
            Edit {
                location: location(number),
                text: old[from].to_owned(),
            }
        });
        let fix = Fix {
            title: "put the arguments in order".to_owned(),
            edits: edits.collect(),
            // The order of the parameters may be wrong instead.
            safe: false,
        };
        let help = format!("write `{word}({})`", texts.join(", "));
        self.in_instance(diagnostic.help(help).fix(fix))
    }
}

/// Returns the index of each parameter with a wrong argument, with the index of its right argument.
/// Returns `None` if several orders are possible.
fn right_order(
    misfits: &[Misfit],
    values: &[BoundValue],
    uses: &[Uses],
) -> Option<Vec<(usize, usize)>> {
    if let [only] = misfits {
        // The argument of an unused parameter can have any kind.
        let mut others = (values.iter().zip(uses).enumerate())
            .filter(|(_, (value, uses))| value.kind() == Some(only.needed.0) && !uses.any())
            .map(|(number, _)| number);
        let first = others.next()?;
        let is_only = others.next().is_none();
        return is_only.then(|| vec![(only.number, first), (first, only.number)]);
    }
    let order = misfits.iter().map(|misfit| {
        let needs_it = |other: &&Misfit| other.needed.0 == misfit.needed.0;
        let mut fitting = misfits
            .iter()
            .filter(|other| other.given == misfit.needed.0);
        let first = fitting.next()?;
        let is_only = fitting.next().is_none() && misfits.iter().filter(needs_it).count() == 1;
        is_only.then_some((misfit.number, first.number))
    });
    order.collect()
}

fn span_of(argument: &Argument) -> Span {
    match argument {
        Argument::Place(place) => place.span,
        Argument::Expr(Expr { span, .. }) => *span,
    }
}
