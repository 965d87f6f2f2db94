//! Prints trees as source. The formatter arranges the lines.
use std::fmt::Write as _;

use crate::Symbols;
use crate::format::lay_out;
use crate::parse::is_unit;
use crate::tree::{
    ArgumentValue, Arrow, Assembly, Chain, EventReference, Expectation, ExpectedEvent, Expr,
    ExprKind, If, Instance, Item, ItemKind, PhaseDeclaration, Place, Quantity, Subscript, Term,
    Tree,
};

/// Returns the source of a tree in the layout of [`crate::format()`]. Parsing it gives the same
/// tree.
pub fn print(tree: &Tree, symbols: &Symbols) -> String {
    let mut printer = Printer {
        symbols,
        out: String::new(),
    };
    for item in &tree.items {
        printer.item(item);
    }
    lay_out(&printer.out).unwrap_or(printer.out)
}

struct Printer<'a> {
    symbols: &'a Symbols,
    out: String,
}

/// Writes formatted text to the printer's output. Writing to a string cannot fail.
macro_rules! put {
    ($printer:expr, $($format:tt)*) => {
        let _ = write!($printer.out, $($format)*);
    };
}

impl Printer<'_> {
    fn word(&self, symbol: crate::Symbol) -> String {
        self.symbols.word(symbol).to_owned()
    }

    fn item(&mut self, item: &Item) {
        for line in item.docs.0.iter().flat_map(|lines| lines.iter()) {
            put!(
                self,
                "///{}{line}\n",
                if line.is_empty() { "" } else { " " }
            );
        }
        match &item.kind {
            ItemKind::Chain(chain) => self.chain(chain),
            ItemKind::Release(release) => {
                self.out.push_str("release ");
                self.list(&release.places, Printer::place);
                self.after(&release.after, release.delay.as_deref());
            }
            ItemKind::Instance(instance) => self.instance(instance),
            ItemKind::Seat(seat) => {
                self.place(&seat.place);
                self.out.push_str(" at ");
                self.pair(&seat.at);
            }
            ItemKind::Let(let_) => {
                put!(self, "let {} = ", self.word(let_.name.symbol));
                self.expr(&let_.value, 0);
            }
            ItemKind::Level(level) => {
                let code = self.word(level.code.symbol);
                put!(self, "{} {code} \"{}\"", level.verdict.word(), level.reason);
            }
            ItemKind::Yields(claim) => {
                let least = if claim.at_least { "at least " } else { "" };
                put!(self, "yields {least}{}", self.word(claim.shape.symbol));
            }
            ItemKind::Expect(claim) => self.expectation(claim),
            ItemKind::Import(import) => {
                put!(self, "import \"{}\"", import.path);
            }
            ItemKind::For(block) => {
                put!(self, "for {} in ", self.word(block.counter.symbol));
                self.range(&block.range.0, &block.range.1);
                self.body(&block.body);
            }
            ItemKind::If(block) => self.condition(block),
            ItemKind::Phase(phase) => self.phase(phase),
            ItemKind::Handler(handler) => {
                self.out.push_str("on timeout");
                self.body(&handler.body);
            }
            ItemKind::Wait(quantity) => {
                self.out.push_str("wait ");
                self.quantity(quantity);
            }
            ItemKind::Retry(count) => {
                self.out.push_str("retry ");
                self.expr(count, 0);
            }
            ItemKind::Seed(seed) => {
                self.out.push_str("seed plate ");
                self.expr(&seed.size.0, 0);
                self.out.push_str(" x ");
                self.expr(&seed.size.1, 0);
                self.body(&seed.body);
            }
            ItemKind::Pattern(pattern) => {
                put!(self, "pattern {}(", self.word(pattern.name.symbol));
                self.list(&pattern.parameters, |printer, parameter| {
                    printer.out.push_str(&printer.word(parameter.name.symbol));
                    if let Some(default) = &parameter.default {
                        printer.out.push_str(" = ");
                        printer.expr(default, 0);
                    }
                });
                self.out.push(')');
                self.body(&pattern.body);
            }
            ItemKind::Assembly(assembly) => self.assembly(assembly),
            ItemKind::Aggregate(aggregate) => {
                put!(self, "aggregate {}", self.word(aggregate.name.symbol));
                if let Some(scene) = aggregate.scene {
                    put!(self, " in {}", self.word(scene.symbol));
                }
                self.out.push_str(" to ");
                self.expr(&aggregate.size, 0);
                if let Some(timeout) = &aggregate.timeout {
                    self.out.push_str(" timeout ");
                    self.quantity(timeout);
                }
            }
            ItemKind::Shape(shape) => self.shape(shape),
            ItemKind::Scene(scene) => {
                put!(self, "scene {}", self.word(scene.name.symbol));
                if let Some(base) = scene.base {
                    put!(self, " from {}", self.word(base.symbol));
                }
                self.out.push_str(" {");
                self.terms(&scene.terms);
                self.out.push('}');
            }
        }
        self.out.push('\n');
    }

    fn phase(&mut self, phase: &PhaseDeclaration) {
        self.out.push_str("phase ");
        self.place(&phase.name);
        if let Some(timeout) = &phase.timeout {
            self.out.push_str(" timeout ");
            self.quantity(timeout);
        }
        self.body(&phase.body);
        if let Some(handler) = &phase.handler {
            self.out.push_str(" on timeout");
            self.body(&handler.body);
        }
    }

    fn expectation(&mut self, claim: &Expectation) {
        self.out.push_str("expect ");
        match claim {
            Expectation::Probability {
                event,
                within,
                relation,
                bound,
            } => {
                self.event(event);
                if let Some(within) = within {
                    self.out.push_str(" within ");
                    self.quantity(within);
                }
                put!(self, " with probability {} ", relation.sign());
                self.quantity(bound);
            }
            Expectation::Mean { relation, bound } => {
                put!(self, "mean completion {} ", relation.sign());
                self.quantity(bound);
            }
            Expectation::Faster { than, by } => {
                put!(self, "faster than {}", self.word(than.symbol));
                if let Some(by) = by {
                    self.out.push_str(" by ");
                    self.quantity(by);
                }
            }
        }
    }

    fn event(&mut self, event: &ExpectedEvent) {
        match event {
            ExpectedEvent::Complete => self.out.push_str("complete"),
            ExpectedEvent::Phase(phase) => {
                self.out.push_str("phase ");
                self.place(phase);
            }
            ExpectedEvent::Captured { block, by } => {
                self.out.push_str("captured ");
                self.place(block);
                self.out.push_str(" by ");
                self.place(by);
            }
        }
    }

    fn condition(&mut self, block: &If) {
        self.out.push_str(if block.is_else { "else" } else { "" });
        if let Some(condition) = &block.condition {
            self.out
                .push_str(if block.is_else { " if " } else { "if " });
            self.expr(condition, 0);
        }
        self.body(&block.body);
    }

    fn assembly(&mut self, assembly: &Assembly) {
        put!(self, "assembly {}", self.word(assembly.name.symbol));
        if !assembly.parameters.is_empty() {
            self.out.push('(');
            self.list(&assembly.parameters, |printer, parameter| {
                put!(printer, "{} = ", printer.word(parameter.name.symbol));
                printer.expr(&parameter.value, 0);
            });
            self.out.push(')');
        }
        if let Some(scene) = assembly.scene {
            put!(self, " in {}", self.word(scene.symbol));
        }
        self.body(&assembly.body);
    }

    fn chain(&mut self, chain: &Chain) {
        self.place(&chain.head);
        for link in &chain.links {
            self.out.push_str(match link.arrow {
                Arrow::One => " -> ",
                Arrow::Row => " ->> ",
            });
            self.place(&link.place);
        }
        self.after(&chain.after, None);
    }

    fn instance(&mut self, instance: &Instance) {
        self.out.push_str(&self.word(instance.pattern.symbol));
        self.out.push('(');
        self.list(&instance.arguments, |printer, argument| {
            if let Some(name) = argument.name {
                put!(printer, "{} = ", printer.word(name.symbol));
            }
            match &argument.value {
                ArgumentValue::Expr(expr) => printer.expr(expr, 0),
                ArgumentValue::Place(place) => printer.place(place),
            }
        });
        self.out.push(')');
        if let Some(placement) = &instance.placement {
            if placement.mirrored {
                self.out.push_str(" mirrored");
            }
            if let Some(angle) = &placement.turned {
                self.out.push_str(" turned ");
                self.expr(angle, 0);
            }
            if let Some(at) = &placement.at {
                self.out.push_str(" at ");
                self.pair(at);
            }
        }
        if let Some(alias) = &instance.alias {
            self.out.push_str(" as ");
            self.place(alias);
        }
    }

    fn body(&mut self, items: &[Item]) {
        self.out.push_str(" {\n");
        for item in items {
            self.item(item);
        }
        self.out.push('}');
    }

    fn shape(&mut self, shape: &crate::tree::Shape) {
        put!(self, "shape {}", self.word(shape.name.symbol));
        if let Some(at) = &shape.at {
            self.out.push_str(" at ");
            self.pair(at);
        }
        self.out.push_str(" {\n");
        for layer in &shape.layers {
            self.out.push_str("layer ");
            self.entry(&layer.heights);
            self.out.push_str(" {\n");
            for row in &layer.rows {
                let cells: Vec<_> = row
                    .cells
                    .iter()
                    .map(|&c| if c { "#" } else { "." })
                    .collect();
                put!(self, "{}\n", cells.join(" "));
            }
            self.out.push_str("}\n");
        }
        self.out.push('}');
    }

    /// Writes the words of a scene. Writes a line break after each block, and between a value and a
    /// word that could be read as the unit of the value.
    fn terms(&mut self, terms: &[Term]) {
        let mut fresh = true;
        let mut valued = false;
        for (i, term) in terms.iter().enumerate() {
            // On the same line, a word such as `s` would be part of the unit before it.
            let taken = matches!(term, Term::Word(name) if is_unit(self.symbols.word(name.symbol)));
            if fresh || (valued && taken) {
                self.out.push('\n');
            } else {
                self.out.push(' ');
            }
            fresh = false;
            valued = matches!(term, Term::Quantity(_) | Term::Range(..));
            match term {
                Term::Word(name) => self.out.push_str(&self.word(name.symbol)),
                Term::Quantity(quantity) => {
                    self.quantity(quantity);
                    self.end_of_value(quantity, terms.get(i + 1));
                }
                Term::Range(first, second) => {
                    self.quantity(first);
                    self.out.push_str(" .. ");
                    self.quantity(second);
                    self.end_of_value(second, terms.get(i + 1));
                }
                Term::Block(terms, _) => {
                    self.out.push('{');
                    self.terms(terms);
                    self.out.push('}');
                    fresh = true;
                }
            }
        }
        self.out.push('\n');
    }

    /// Ends a value. If it ends in the unit `tick` and another value follows, appends `^1`. A plain
    /// `tick` would be read as the start of a clause.
    fn end_of_value(&mut self, quantity: &Quantity, next: Option<&Term>) {
        let is_tick = quantity
            .unit
            .last()
            .is_some_and(|it| it.symbol == "tick" && it.power == 1);
        if is_tick && matches!(next, Some(Term::Quantity(_) | Term::Range(..))) {
            self.out.push_str("^1");
        }
    }

    fn quantity(&mut self, quantity: &Quantity) {
        put!(self, "{}", quantity.value);
        for (i, factor) in quantity.unit.iter().enumerate() {
            // A unit cannot begin with a division. A negative power has the same meaning.
            let (sign, power) = match (i, factor.power) {
                (0, power) => (" ", power),
                (_, power @ ..=-1) => ("/", -power),
                (_, power) => (" ", power),
            };
            put!(self, "{sign}{}", factor.symbol);
            if power != 1 {
                put!(self, "^{power}");
            }
        }
    }

    fn after(&mut self, subjects: &[EventReference], delay: Option<&Quantity>) {
        if subjects.is_empty() && delay.is_none() {
            return;
        }
        self.out.push_str(" after ");
        self.list(subjects, |printer, subject| {
            if subject.release {
                printer.out.push_str("release ");
            }
            printer.place(&subject.place);
        });
        if let Some(delay) = delay {
            self.out
                .push_str(if subjects.is_empty() { "" } else { ", " });
            self.quantity(delay);
        }
    }

    fn place(&mut self, place: &Place) {
        for (i, segment) in place.path.iter().enumerate() {
            if i > 0 {
                self.out.push('.');
            }
            self.out.push_str(&self.word(segment.name.symbol));
            if let Some(index) = &segment.index {
                self.out.push('[');
                self.list(index, Printer::entry);
                self.out.push(']');
            }
        }
        if let Some((face, _)) = place.face {
            let dot = if place.path.is_empty() { "" } else { "." };
            put!(self, "{dot}{face}");
        }
    }

    fn entry(&mut self, entry: &Subscript) {
        match entry {
            Subscript::One(expr) => self.expr(expr, 0),
            Subscript::Range(first, last) => self.range(first, last),
        }
    }

    fn range(&mut self, first: &Expr, last: &Expr) {
        self.expr(first, 0);
        self.out.push_str("..");
        self.expr(last, 0);
    }

    fn pair(&mut self, (first, second): &(Expr, Expr)) {
        self.out.push('(');
        self.expr(first, 0);
        self.out.push_str(", ");
        self.expr(second, 0);
        self.out.push(')');
    }

    /// Writes an expression, with parentheses if its operator binds less tightly than `least`.
    fn expr(&mut self, expr: &Expr, least: u8) {
        match &expr.kind {
            ExprKind::Int(value) => {
                put!(self, "{value}");
            }
            ExprKind::Name(symbol) => self.out.push_str(&self.word(*symbol)),
            ExprKind::Face(face) => self.out.push_str(face.word()),
            ExprKind::Negate(inner) => {
                let plain = matches!(inner.kind, ExprKind::Name(_));
                self.out.push_str(if plain { "-" } else { "-(" });
                self.expr(inner, 0);
                self.out.push_str(if plain { "" } else { ")" });
            }
            ExprKind::Call(function, arguments) => {
                put!(self, "{}(", function.word());
                self.list(arguments, |printer, argument| printer.expr(argument, 0));
                self.out.push(')');
            }
            ExprKind::Not(inner) => {
                self.out.push_str("not (");
                self.expr(inner, 0);
                self.out.push(')');
            }
            ExprKind::Binary(operator, sides) => {
                let precedence = operator.precedence();
                let group = precedence < least;
                if group {
                    self.out.push('(');
                }
                self.expr(&sides.0, precedence);
                put!(self, " {} ", operator.sign());
                self.expr(&sides.1, precedence + 1);
                if group {
                    self.out.push(')');
                }
            }
        }
    }

    fn list<T>(&mut self, items: &[T], one: impl Fn(&mut Self, &T)) {
        for (i, item) in items.iter().enumerate() {
            if i > 0 {
                self.out.push_str(", ");
            }
            one(self, item);
        }
    }
}
