//! Checks the arguments of patterns.
use stochc_grammar::Span;
use stochc_grammar::tree::{
    ArgumentValue, Expr, ExprKind, Instance, Name, Parameter, Pattern, Place,
};
use stochc_text::counted;
use stochc_text::suggest::nearest;

use super::expander::{Expander, Seeding};
use super::frame::Frame;
use super::place::suggested_face;
use super::scope::BoundValue;
use super::uses::Uses;
use crate::diagnostic::{Code, Diagnostic, Edit, Fix, suggestion};
use crate::expanded::{NameKey, PatternInstance};
use crate::names::ValueKind;
use crate::{FileId, SourceLocation};

/// An argument whose kind differs from the required kind.
struct Misfit {
    /// Index of the parameter.
    number: usize,
    /// Index of the argument.
    argument: usize,
    /// Kind of the argument.
    given: ValueKind,
    /// Required kind, and the location of the use that requires it.
    needed: (ValueKind, SourceLocation),
}

impl<'a> Expander<'a, '_> {
    /// Returns the value of each parameter of an instance. Returns `None` for parameters with
    /// their default value. Reports arguments of the wrong kind and makes them unknown.
    pub(super) fn arguments(
        &mut self,
        instance: &'a Instance,
        (file, pattern): (FileId, &'a Pattern),
        assigned: &[Option<usize>],
    ) -> Vec<Option<BoundValue>> {
        self.steps = self.steps.saturating_add(instance.arguments.len());
        let given: Vec<BoundValue> = (instance.arguments.iter())
            .map(|argument| self.argument(&argument.value))
            .collect();
        let mut values: Vec<Option<BoundValue>> = (assigned.iter())
            .map(|argument| argument.map(|argument| given[argument]))
            .collect();
        let uses = (self.known).uses((file, pattern), &self.declared.patterns, self.names);
        let misfits: Vec<Misfit> = (values.iter().zip(&*uses).enumerate())
            .filter_map(|(number, (&value, uses))| {
                let (given, needed) = (value?.kind()?, uses.only()?);
                let argument = assigned[number]?;
                (given != needed.0).then_some(Misfit {
                    number,
                    argument,
                    given,
                    needed,
                })
            })
            .collect();
        if misfits.is_empty() {
            return values;
        }
        let is_in_order = instance.arguments.iter().all(|it| it.name.is_none());
        let order = (is_in_order.then(|| right_order(&misfits, &given, &uses))).flatten();
        if let Some(order) = order {
            let diagnostic = self.wrong_order(instance, pattern, &misfits, &order);
            self.diagnostics.push(diagnostic);
        } else {
            for misfit in &misfits {
                self.misfit(instance, pattern, misfit, given[misfit.argument]);
            }
        }
        for misfit in &misfits {
            values[misfit.number] = Some(BoundValue::Unknown);
        }
        values
    }

    /// Returns the index of the argument for each parameter. Returns `None` for parameters with
    /// their default value. Returns `None` and reports an error if the arguments do not fit.
    pub(super) fn assign_arguments(
        &mut self,
        instance: &Instance,
        (file, pattern): (FileId, &Pattern),
        span: Span,
    ) -> Option<Vec<Option<usize>>> {
        let arguments = &instance.arguments[..];
        let parameters = &pattern.parameters[..];
        let named = arguments.iter().position(|it| it.name.is_some());
        let positional = named.unwrap_or(arguments.len());
        let mut assigned = vec![None; parameters.len()];
        for (number, argument) in arguments.iter().enumerate() {
            let parameter = match argument.name {
                Some(name) => Some(self.named_parameter(name, pattern)?),
                None if number > positional => {
                    let diagnostic = Diagnostic::new(
                        Code::WrongArguments,
                        "an argument without a name follows an argument with a name",
                    )
                    .label(self.location(span_of(&argument.value)), "has no name")
                    .help("write arguments without names first");
                    self.diagnostics.push(diagnostic);
                    return None;
                }
                None => (number < parameters.len()).then_some(number),
            };
            let Some(slot) = parameter.map(|parameter| &mut assigned[parameter]) else {
                continue;
            };
            if let (Some(_), Some(name)) = (slot.replace(number), argument.name) {
                let word = self.symbols.word(name.symbol);
                let title = format!("parameter `{word}` has two arguments");
                let diagnostic = Diagnostic::new(Code::WrongArguments, title)
                    .label(self.location(name.span), "second argument")
                    .help("remove one of them");
                self.diagnostics.push(diagnostic);
                return None;
            }
        }
        let is_missing = |(slot, parameter): (&Option<usize>, &Parameter)| {
            slot.is_none() && parameter.default.is_none()
        };
        if positional > parameters.len() || assigned.iter().zip(parameters).any(is_missing) {
            let diagnostic = self.wrong_count(instance, (file, pattern), span);
            self.diagnostics.push(diagnostic);
            return None;
        }
        Some(assigned)
    }

    /// Returns the index of the parameter with a name. Returns `None` and reports an error if there
    /// is none.
    fn named_parameter(&mut self, name: Name, pattern: &Pattern) -> Option<usize> {
        let mut parameters = pattern.parameters.iter();
        let number = parameters.position(|it| it.name.symbol == name.symbol);
        if number.is_none() {
            let location = self.location(name.span);
            let words = [pattern.name, name].map(|name| self.symbols.word(name.symbol));
            let title = "pattern `{}` has no parameter `{}`";
            let known = pattern.parameters.iter();
            let known = known.map(|it| self.symbols.word(it.name.symbol));
            let suggested = suggestion(self.diagnostics, words[1], known);
            let diagnostic = Diagnostic::about(Code::UnknownName, title, &words)
                .label(location, "unknown parameter")
                .suggest(location, suggested, || {
                    "remove the name, or use the name of a parameter".to_owned()
                });
            self.diagnostics.push(diagnostic);
        }
        number
    }

    /// Returns the error for too many or too few arguments.
    fn wrong_count(
        &self,
        instance: &Instance,
        (file, pattern): (FileId, &Pattern),
        span: Span,
    ) -> Diagnostic {
        let parameters = &pattern.parameters[..];
        let most = parameters.len();
        let least = parameters.iter().filter(|it| it.default.is_none()).count();
        let takes = match most - least {
            0 => counted(most, "argument"),
            1 => format!("{least} or {}", counted(most, "argument")),
            _ => format!("{least} to {}", counted(most, "argument")),
        };
        let word = self.symbols.word(pattern.name.symbol);
        let given = instance.arguments.len();
        let title = if (least..=most).contains(&given) {
            format!("an argument of `{word}` is missing")
        } else {
            format!("`{word}` takes {takes}, not {given}")
        };
        let needed = parameters
            .iter()
            .filter(|it| it.default.is_none() || most == least);
        let needed: Vec<&str> = needed.map(|it| self.symbols.word(it.name.symbol)).collect();
        let suffix = if most == least {
            ""
        } else {
            " without a default value"
        };
        let declared = SourceLocation {
            file,
            span: pattern.name.span,
        };
        Diagnostic::new(Code::WrongArguments, title)
            .label(self.location(span), counted(given, "argument"))
            .label(declared, counted(most, "parameter"))
            .help(format!(
                "write `{word}({})` with a value for each parameter{suffix}",
                needed.join(", ")
            ))
    }

    /// Returns the frame of an instance inside the frame around it. Returns `None` and reports an
    /// error if it is unknown.
    pub(super) fn frame_of(&mut self, instance: &Instance) -> Option<Frame> {
        let Some(placement) = &instance.placement else {
            return Some(Frame::default());
        };
        if let Some((x, _)) = placement.at.as_ref().filter(|_| self.seeding.is_none()) {
            let diagnostic = Diagnostic::new(
                Code::Misplaced,
                "an instance outside of a seed plate has no position",
            )
            .label(self.location(x.span), "moves only seeds")
            .help("remove `at`: the blocks of this instance are attached to its arguments");
            self.diagnostics.push(diagnostic);
        }
        let mut frame = Frame {
            is_mirrored: placement.mirrored,
            ..Frame::default()
        };
        if let Some(expr) = &placement.turned {
            let angle = self.evaluate(expr)?;
            if angle % 90 != 0 {
                let title = format!("an instance cannot be turned by {angle} degrees");
                let diagnostic = Diagnostic::new(Code::WrongValue, title)
                    .label(self.location(expr.span), "not a multiple of 90")
                    .help("write `turned 90`, `turned 180` or `turned 270`");
                self.diagnostics.push(self.in_instance(diagnostic));
                return None;
            }
            frame.quarters = (angle / 90).rem_euclid(4) as u8;
        }
        if let Some((x, y)) = &placement.at {
            let (x, y) = (self.evaluate(x), self.evaluate(y));
            frame.offset = (x?, y?);
        }
        Some(frame)
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

    fn argument(&mut self, argument: &'a ArgumentValue) -> BoundValue {
        match argument {
            ArgumentValue::Place(place) => {
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
            ArgumentValue::Expr(expr) => {
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
                self.evaluate_any(expr)
            }
        }
    }

    fn single_block(&mut self, place: &'a Place) -> BoundValue {
        let Some((key, _)) =
            self.single(place, "pass one block, or use the pattern in a loop", None)
        else {
            return BoundValue::Unknown;
        };
        // Seeds have the first roles.
        if self.seeding != Some(Seeding::Seats) {
            self.role(key);
        }
        BoundValue::Block(key)
    }

    fn misfit(
        &mut self,
        instance: &'a Instance,
        pattern: &'a Pattern,
        misfit: &Misfit,
        value: BoundValue,
    ) {
        let argument = &instance.arguments[misfit.argument].value;
        let (needed, used) = misfit.needed;
        let location = self.location(span_of(argument));
        let name = |symbol| self.symbols.word(symbol);
        let parameter = pattern.parameters[misfit.number].name;
        let label = format!(
            "`{}` is used as {} here",
            name(parameter.symbol),
            needed.noun()
        );
        // An unknown bare name was taken for a block.
        let unknown = match (argument, value) {
            (ArgumentValue::Expr(expr), BoundValue::Block(key))
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
        let location = |number: usize| self.location(span_of(&instance.arguments[number].value));
        let title = match order.len() {
            2 => format!("two arguments of `{word}` are swapped"),
            _ => format!("the arguments of `{word}` are in the wrong order"),
        };
        let mut diagnostic = Diagnostic::new(Code::WrongKind, title);
        for misfit in misfits {
            let parameter = self
                .symbols
                .word(pattern.parameters[misfit.number].name.symbol);
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

fn span_of(argument: &ArgumentValue) -> Span {
    match argument {
        ArgumentValue::Place(place) => place.span,
        ArgumentValue::Expr(Expr { span, .. }) => *span,
    }
}
