//! State of an expansion, and the items of an assembly.
use rustc_hash::FxHashMap;
use stochc_grammar::tree::{Assembly, Item, ItemKind, Let, Name, PhaseDeclaration, Quantity};
use stochc_grammar::{Cancellation, Span, Symbol, Symbols};
use stochc_ir::table::{Plate, RoleId};

use super::branches::Branches;
use super::declared_items::DeclaredItems;
use super::duplicate::duplicate;
use super::frame::Frame;
use super::limits::{ExpansionSettings, Limits, MAX_NESTING};
use super::probe::Probe;
use super::scope::{BoundValue, Scope};
use super::uses;
use crate::check::changes::ParameterChange;
use crate::diagnostic::{Code, Diagnostic, Fix, LONG, has_enough_errors, removal, report};
use crate::expanded::{
    AfterConstraint, EventId, ExpandedEvent, ExpandedPhase, ExpandedProgram, NameKey, Roles,
    ShapeClaim, Timeout,
};
use crate::names::{Definition, Names};
use crate::{FileId, SourceLocation, Sources};

/// Declarations of the files.
pub struct Declarations<'a> {
    pub declared: DeclaredItems<'a>,
    /// `let` declarations with their files, in source order.
    pub lets: Vec<(FileId, &'a Item)>,
    pub names: &'a Names,
}

/// Pass of the expansion over a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pass {
    /// Records events and names.
    Writing,
    /// Counts events only.
    Counting,
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ExpansionSize {
    pub(super) seeds: usize,
    pub(super) events: usize,
    pub(super) afters: usize,
    pub(super) instances: usize,
    pub(super) phases: usize,
    pub(super) claims: usize,
}

impl ExpansionSize {
    fn total(self) -> usize {
        let ExpansionSize {
            seeds,
            events,
            afters,
            instances,
            phases,
            claims,
        } = self;
        seeds + events + afters + instances + phases + claims
    }
}

/// The passes through a seed plate. Seeds are expanded first, so that they get the first role
/// numbers.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Seeding {
    /// First pass: expands the seeds.
    Seats,
    /// Second pass: expands the pre-attached blocks.
    Captures,
    /// Last pass: expands the phases of instances.
    Phases,
}

pub(super) struct Expander<'a, 'f> {
    pub(super) plan: ExpandedProgram,
    pub(super) declared: DeclaredItems<'a>,
    pub(super) names: &'a Names,
    pub(super) scope: Scope,
    /// Uses of the parameters of patterns.
    pub(super) known: uses::KnownUses,
    /// Numbers that the files declare.
    pub(super) lets: Vec<(FileId, &'a Item)>,
    /// Blocks of statements around the current statement, in the assembly and in the pattern. The
    /// outermost comes first.
    pub(super) blocks: Vec<&'a [Item]>,
    pub(super) file: FileId,
    /// Frame of the current instance.
    pub(super) frame: Frame,
    /// Patterns that are being expanded, the innermost last.
    pub(super) instances: Vec<(Symbol, SourceLocation)>,
    /// Number of instances without a name.
    pub(super) anonymous: u32,
    /// Number of the last instance without a name in a phase that an instance in the seed plate
    /// contains.
    pub(super) anonymous_in_phases: u32,
    nesting: usize,
    pub(super) steps: usize,
    /// Number of operations in expressions since the last counted step.
    pub(super) operations: usize,
    /// Number of diagnostics at the last count, and whether the limit of errors is reached.
    pub(super) errors: (usize, bool),
    pub(super) limits: Limits,
    pub(super) cancellation: Cancellation<'f>,
    /// Values that replace the default values of parameters.
    parameters: &'f [ParameterChange],
    pub(super) pass: Pass,
    pub(super) grown: ExpansionSize,
    /// Whether a limit is reached and expansion has stopped.
    pub(super) exhausted: bool,
    /// Whether the exceeded limit is [`Limits::events`].
    pub(super) outgrown: bool,
    pub(super) plate: Option<SourceLocation>,
    phase_sites: FxHashMap<String, SourceLocation>,
    pub(super) in_phase: bool,
    /// Whether the current `if` or one of its `else if` is true. `None` if this is unknown.
    pub(super) has_branch: Option<bool>,
    /// Numbers that the conditions of the current `if` name.
    pub(super) compared: Vec<(Symbol, i64)>,
    pub(super) seeding: Option<Seeding>,
    pub(super) sources: &'f Sources,
    pub(super) symbols: &'f mut Symbols,
    pub(super) diagnostics: &'f mut Vec<Diagnostic>,
    pub(super) probe: &'f mut Probe,
}

impl<'a, 'f> Expander<'a, 'f> {
    pub(super) fn new(
        declarations: &Declarations<'a>,
        (file, name): (FileId, Name),
        sources: &'f Sources,
        symbols: &'f mut Symbols,
        settings: ExpansionSettings<'f>,
        diagnostics: &'f mut Vec<Diagnostic>,
        probe: &'f mut Probe,
    ) -> Expander<'a, 'f> {
        let mut expander = Expander {
            plan: ExpandedProgram {
                name: symbols.word(name.symbol).to_owned(),
                location: SourceLocation {
                    file,
                    span: name.span,
                },
                parameters: Vec::new(),
                plate: Plate { width: 0, depth: 0 },
                seeds: Vec::new(),
                roles: Roles::default(),
                phases: Vec::new(),
                events: Vec::new(),
                afters: Vec::new(),
                delays: Vec::new(),
                aggregate: None,
                claims: Vec::new(),
                grown: Vec::new(),
                steps: 0,
                branches: Branches::default(),
                uncertain: Default::default(),
            },
            declared: declarations.declared.clone(),
            names: declarations.names,
            scope: Scope::default(),
            known: uses::KnownUses::default(),
            lets: declarations.lets.clone(),
            blocks: Vec::new(),
            file,
            frame: Frame::default(),
            instances: Vec::new(),
            anonymous: 0,
            anonymous_in_phases: 0,
            nesting: 0,
            steps: 0,
            operations: 0,
            errors: (0, false),
            limits: settings.limits,
            cancellation: settings.cancellation,
            parameters: settings.parameters,
            pass: Pass::Writing,
            grown: ExpansionSize::default(),
            exhausted: false,
            outgrown: false,
            plate: None,
            phase_sites: FxHashMap::default(),
            in_phase: false,
            has_branch: None,
            compared: Vec::new(),
            seeding: None,
            sources,
            symbols,
            diagnostics,
            probe,
        };
        for &(file, item) in &declarations.lets {
            expander.file = file;
            expander.declaration(item);
        }
        expander.file = file;
        expander
    }
}

impl<'a> Expander<'a, '_> {
    pub(super) fn assembly(&mut self, assembly: &'a Assembly) {
        // Patterns and shapes may be declared after their use.
        self.declare(&assembly.body);
        let mark = self.scope.mark();
        for parameter in &assembly.parameters {
            self.parameter(parameter);
        }
        self.reject_hidden_parameters(assembly);
        self.items(&assembly.body);
        self.scope.restore(mark);
        if self.plate.is_none() {
            self.diagnostics.push(
                Diagnostic::new(
                    Code::MissingPlate,
                    format!("assembly `{}` has no seed plate", self.plan.name),
                )
                .label(self.plan.location, "every structure starts at a seed")
                .help("add `seed plate 3 x 3 { M at (1, 1) }` before the first phase"),
            );
        } else if self.plan.phases.iter().all(|phase| phase.pre_attached) {
            let title = format!("assembly `{}` has no phases", self.plan.name);
            let diagnostic = Diagnostic::new(Code::EmptyPhase, title)
                .label(self.plan.location, "it captures no blocks")
                .help("add a phase, such as `phase grow { M.up -> A }`");
            self.diagnostics.push(diagnostic);
        }
    }

    /// Defines a parameter with its default value or with the value that replaces it.
    fn parameter(&mut self, parameter: &Let) {
        let default = self.evaluate(&parameter.value);
        let word = self.symbols.word(parameter.name.symbol).to_owned();
        // As in scenes, the last of several values applies.
        let replaced = self.parameters.iter().rfind(|it| it.name == word);
        let value = replaced.and_then(|it| it.integer).or(default);
        self.define(
            parameter.name,
            value.map_or(BoundValue::Unknown, BoundValue::Number),
        );
        (self.plan.parameters).extend(value.map(|value| (word, value)));
    }

    /// Reports each `let` of an assembly that has the name of a parameter.
    fn reject_hidden_parameters(&mut self, assembly: &Assembly) {
        for item in &assembly.body {
            let ItemKind::Let(let_) = &item.kind else {
                continue;
            };
            let mut parameters = assembly.parameters.iter();
            let name = let_.name;
            if let Some(old) = parameters.find(|it| it.name.symbol == name.symbol) {
                let [old, new] = [old.name, name].map(|name| self.location(name.span));
                let word = self.symbols.word(name.symbol);
                let diagnostic = duplicate(word, old, new, "a number", self.symbols);
                report(self.diagnostics, diagnostic);
            }
        }
    }

    pub(super) fn declare(&mut self, items: &'a [Item]) {
        for item in items {
            let written = (self.file, item);
            let duplicate = (self.declared).declare(written, self.names, self.symbols);
            self.diagnostics.extend(duplicate);
        }
    }

    pub(super) fn items(&mut self, items: &'a [Item]) {
        if self.nesting >= MAX_NESTING {
            if let Some(item) = items.first() {
                self.exhausted = true;
                let location = self.location(item.span);
                self.diagnostics.push(
                    Diagnostic::new(
                        Code::TooDeep,
                        format!(
                            "patterns and loops are nested more than {MAX_NESTING} levels deep"
                        ),
                    )
                    .label(location, format!("this is level {}", MAX_NESTING + 1))
                    .help("use a loop or `->>` instead of nested patterns"),
                );
            }
            return;
        }
        self.nesting += 1;
        self.blocks.push(items);
        let mark = self.scope.mark();
        let outer = self.has_branch.take();
        for item in items {
            if self.exhausted || !self.step(item.span) {
                break;
            }
            self.item(item);
        }
        self.has_branch = outer;
        self.scope.restore(mark);
        self.blocks.pop();
        self.nesting -= 1;
    }

    /// Counts a statement. Returns whether the expansion continues.
    pub(super) fn step(&mut self, span: Span) -> bool {
        if self.cancellation.is_cancelled() {
            self.exhausted = true;
            return false;
        }
        self.steps += 1;
        let most = self.limits;
        // Names and dependencies use memory as well.
        let grown = self.grown.total().max(self.plan.roles.count());
        let reported = self.diagnostics.len();
        if self.errors.0 != reported {
            self.errors = (reported, has_enough_errors(self.diagnostics));
        }
        let has_enough = self.errors.1;
        if self.steps <= most.steps && grown <= most.events && !has_enough {
            return true;
        }
        self.exhausted = true;
        if has_enough {
            if !(self.diagnostics.iter()).any(|it| it.code == Code::TooManyErrors) {
                self.diagnostics.push(
                    Diagnostic::new(Code::TooManyErrors, "too many errors")
                        .label(self.location(span), "expansion stopped here")
                        .help("fix the first ones and check again"),
                );
            }
            return false;
        }
        let (count, what) = if self.steps > most.steps {
            (most.steps, "statements")
        } else {
            self.outgrown = true;
            (
                most.events,
                "captures, releases, seeds and names in `after`",
            )
        };
        let mut diagnostic = Diagnostic::new(
            Code::ExpansionLimit,
            format!("the program has more than {count} {what}"),
        )
        .label(
            self.location(span),
            "the limit is reached in this statement",
        );
        for &(_, location) in self.instances.iter().rev().take(3) {
            diagnostic = diagnostic.label(location, "in this instance");
        }
        let help = "check the ranges of loops, and patterns inside of patterns";
        self.diagnostics
            .push(diagnostic.help(self.limits.help(help)));
        false
    }

    pub(super) fn item(&mut self, item: &'a Item) {
        if !self.belongs(item) || self.is_misplaced(item) {
            return;
        }
        match &item.kind {
            ItemKind::Chain(chain) => self.chain(chain),
            ItemKind::Release(release) => self.release(release),
            ItemKind::Instance(instance) => self.instance(instance, item.span),
            ItemKind::For(block) => self.repeat(block),
            ItemKind::If(block) => self.branch(block, item.span),
            ItemKind::Let(_) => self.declaration(item),
            ItemKind::Seed(seed) => self.seed_plate(seed, item.span),
            ItemKind::Seat(seat) => self.seat(seat, item),
            ItemKind::Phase(phase) => self.phase(phase, item),
            ItemKind::Yields(claim) => {
                let location = self.location(claim.shape.span);
                self.grown.claims += 1;
                if let Some(phase) = self.plan.phases.last_mut() {
                    phase.claims.push(ShapeClaim {
                        shape: claim.shape.symbol,
                        at_least: claim.at_least,
                        location,
                    });
                }
            }
            ItemKind::Expect(claim) => self.claim(claim, item.span),
            ItemKind::Wait(quantity) => {
                let time = self.time(Some(quantity), "`wait`");
                if let (Some(time), Some(phase)) = (time, self.plan.phases.last_mut()) {
                    phase.waits.push(time);
                }
            }
            // These items have been declared before, or are not a part of an assembly.
            ItemKind::Pattern(_)
            | ItemKind::Shape(_)
            | ItemKind::Scene(_)
            | ItemKind::Assembly(_)
            | ItemKind::Aggregate(_)
            | ItemKind::Import(_)
            | ItemKind::Level(_)
            | ItemKind::Handler(_)
            | ItemKind::Retry(_) => {}
        }
    }

    /// Returns whether the current pass through the seed plate expands an item.
    fn belongs(&self, item: &Item) -> bool {
        use ItemKind as K;
        let is_in_every_pass =
            item.is_transparent() || matches!(item.kind, K::Let(_) | K::Instance(_));
        match self.seeding {
            None => true,
            Some(Seeding::Seats) => !matches!(item.kind, K::Chain(_) | K::Phase(_)),
            Some(Seeding::Captures) => is_in_every_pass || matches!(item.kind, K::Chain(_)),
            Some(Seeding::Phases) => is_in_every_pass || matches!(item.kind, K::Phase(_)),
        }
    }

    /// Reports a statement of a pattern that is not valid at the place of the instance. The parser
    /// reports other misplaced statements.
    fn is_misplaced(&mut self, item: &Item) -> bool {
        use ItemKind as K;
        let (is_misplaced, belongs) = match &item.kind {
            K::Seat(_) => (self.seeding.is_none(), "a seed plate"),
            K::Phase(_) => (self.in_phase, "an assembly or a seed plate"),
            K::Chain(chain) if self.seeding.is_some() => (!chain.after.is_empty(), "a phase"),
            K::Chain(_) | K::Release(_) | K::Wait(_) => (!self.in_phase, "a phase"),
            _ => (false, ""),
        };
        let Some(&(_, instance)) = self.instances.last().filter(|_| is_misplaced) else {
            return false;
        };
        let what = match &item.kind {
            K::Chain(chain) if !chain.after.is_empty() && self.seeding.is_some() => "an `after`",
            _ => item.noun(),
        };
        let title = format!("{what} of a pattern is outside of {belongs}");
        let diagnostic = Diagnostic::new(Code::Misplaced, title)
            .label(self.location(item.span), format!("belongs into {belongs}"))
            .label(instance, "in this instance")
            .help(format!("write the instance into {belongs}"));
        self.diagnostics.push(diagnostic);
        self.mark_all_uncertain(std::slice::from_ref(item));
        true
    }

    pub(super) fn declaration(&mut self, item: &'a Item) {
        let ItemKind::Let(let_) = &item.kind else {
            return;
        };
        // A value in doubt is declared without a value.
        let value = self.evaluate_any(&let_.value);
        self.define(let_.name, value);
    }

    /// Defines a name in the current block of statements. Reports an error if the block already
    /// defines it.
    pub(super) fn define(&mut self, name: Name, value: BoundValue) {
        let location = self.location(name.span);
        if let Some(old) = self.scope.define(self.named(name), value, location) {
            let diagnostic = duplicate(
                self.symbols.word(name.symbol),
                old,
                location,
                "a `let`",
                self.symbols,
            );
            report(self.diagnostics, diagnostic);
        }
    }

    /// Returns the word of a name, and its definition if it names a number, counter or parameter.
    pub(super) fn named(&self, name: Name) -> (Symbol, Option<Definition>) {
        (name.symbol, self.names.definition(self.file, name.span))
    }

    /// Returns the value of a name. Returns `None` if it has no value in the current scope.
    pub(super) fn value(&self, name: Name) -> Option<BoundValue> {
        let (word, definition) = self.named(name);
        self.scope.get(word, definition?).map(|(value, _)| value)
    }

    pub(super) fn phase(&mut self, phase: &'a PhaseDeclaration, item: &'a Item) {
        // A phase inside a phase has been reported. Its statements belong to the outer one.
        if self.in_phase {
            return self.items(&phase.body);
        }
        let location = self.location(phase.name.span);
        let Some(name) = self.single_key(&phase.name) else {
            return self.mark_all_uncertain(&phase.body);
        };
        let name = self.plan.roles.name_of(name, self.symbols);
        if let Some(&old) = self.phase_sites.get(&name) {
            self.diagnostics
                .push(duplicate(&name, old, location, "a phase", self.symbols));
        }
        if self.pass == Pass::Writing {
            self.phase_sites.insert(name.clone(), location);
        }
        let timeout = self.time(phase.timeout.as_ref(), "timeout");
        let start = self.grown.events as u32;
        self.push_phase(ExpandedPhase {
            name,
            location,
            timeout,
            events: start..start,
            pre_attached: false,
            claims: Vec::new(),
            recovery: None,
            waits: Vec::new(),
        });
        self.in_phase = true;
        // This also applies after a misplaced plate, which has been reported.
        let seeding = self.seeding.take();
        let is_in_instance = seeding == Some(Seeding::Phases);
        let outside = self.anonymous;
        if is_in_instance {
            self.anonymous = self.anonymous_in_phases;
        }
        self.items(&phase.body);
        if is_in_instance {
            self.anonymous_in_phases = self.anonymous;
            self.anonymous = outside;
        }
        self.seeding = seeding;
        self.in_phase = false;
        let end = self.grown.events as u32;
        let recovery = self.recovery(phase, start);
        if let Some(planned) = self.plan.phases.last_mut() {
            planned.recovery = recovery;
            planned.events.end = end;
            if start == end && planned.claims.is_empty() && planned.waits.is_empty() {
                let mut diagnostic = Diagnostic::new(
                    Code::EmptyPhase,
                    format!("phase `{}` has no captures or releases", planned.name),
                )
                .label(location, "the phase ends in its first tick")
                .help("remove it, or check the ranges of its loops");
                if phase.body.is_empty() && item.docs.0.is_none() {
                    diagnostic.fix = self.without(item);
                }
                report(self.diagnostics, diagnostic);
            }
        }
    }

    /// Returns the role of a name. Creates the role if needed.
    pub(super) fn role(&mut self, key: NameKey) -> RoleId {
        match self.pass {
            Pass::Writing => self.plan.roles.intern(key),
            Pass::Counting => RoleId(0),
        }
    }

    /// Returns the scope of an instance.
    pub(super) fn instance_of(&mut self, key: NameKey) -> u32 {
        self.grown.instances += 1;
        match self.pass {
            Pass::Writing => self.plan.roles.intern_scope(key),
            Pass::Counting => key.scope,
        }
    }

    pub(super) fn push_event(&mut self, event: ExpandedEvent) -> EventId {
        let id = EventId(self.grown.events as u32);
        self.grown.events += 1;
        if self.pass == Pass::Writing {
            self.plan.events.push(event);
        }
        id
    }

    pub(super) fn push_after(&mut self, after: AfterConstraint) {
        self.grown.afters += 1;
        if self.pass == Pass::Writing {
            self.plan.afters.push(after);
        }
    }

    pub(super) fn push_phase(&mut self, phase: ExpandedPhase) {
        self.grown.phases += 1;
        if self.pass == Pass::Writing {
            self.plan.phases.push(phase);
        }
    }

    /// Returns a time. Reports an error if the quantity is not a positive time. `noun` names
    /// the time in the message.
    pub(super) fn time(&mut self, quantity: Option<&Quantity>, noun: &str) -> Option<Timeout> {
        let quantity = quantity?;
        let timeout = Timeout::from_quantity(quantity);
        if timeout.is_none() {
            let lacks_unit = quantity.unit.is_empty() && quantity.value != 0.0;
            let (title, label, help) = if lacks_unit {
                (
                    format!("a {noun} has no unit"),
                    "the unit is missing",
                    format!(
                        "write `{0} ticks` or `{0} s`; ms, min and h are known as well",
                        quantity.value
                    ),
                )
            } else if Timeout::is_in_ticks(quantity) && quantity.value > 0.0 {
                (
                    format!("a {noun} in ticks must be a whole number"),
                    "not a whole number below 9e15",
                    "write `40000 ticks`, or a time such as `800 s`".to_owned(),
                )
            } else if quantity.value != 0.0 && !Timeout::is_a_time(quantity) {
                (
                    format!("a {noun} must be a time"),
                    "this value is not a time",
                    "write `800 s` or `40000 ticks`; minutes are `min`".to_owned(),
                )
            } else {
                (
                    format!("a {noun} must be more than 0"),
                    "this time is 0 or negative",
                    "write `800 s` or `40000 ticks`".to_owned(),
                )
            };
            let diagnostic = Diagnostic::new(Code::WrongDimension, title);
            let diagnostic = diagnostic.label(self.location(quantity.span), label);
            self.diagnostics.push(diagnostic.help(help));
        }
        timeout
    }

    /// Returns a fix that removes a block of statements. Returns `None` if the block is not empty.
    pub(super) fn without(&self, block: &Item) -> Option<Fix> {
        let location = self.location(block.span);
        if block.span.len() > LONG {
            return None;
        }
        let (_, body) = self.sources.text(location).split_once('{')?;
        let title = format!("remove {}", block.noun().replacen("a ", "the ", 1));
        (body.trim() == "}").then(|| Fix::remove(removal(self.sources, location), title))
    }

    /// Adds the location of the current instance to a diagnostic.
    pub(super) fn in_instance(&self, diagnostic: Diagnostic) -> Diagnostic {
        match self.instances.last() {
            Some(&(_, location)) => diagnostic.label(location, "in this instance"),
            None => diagnostic,
        }
    }

    pub(super) fn location(&self, span: Span) -> SourceLocation {
        SourceLocation {
            file: self.file,
            span,
        }
    }
}
