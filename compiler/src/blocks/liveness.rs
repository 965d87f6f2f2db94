//! Checks which blocks are attached under which names, phase by phase.
use rustc_hash::{FxHashMap, FxHashSet};
use stochc_grammar::{Cancellation, Cancelled, Symbol, Symbols};
use stochc_ir::table::{RoleId, Trigger};

use crate::diagnostic::{
    Code, Diagnostic, Fix, Severity, entry, is_full, is_repeated, last_named, named,
    parameter_hint, removal, report, suggestion,
};
use crate::expand::members::members;
use crate::expanded::{EventId, EventKind, ExpandedProgram, NameKey, PatternInstance};
use crate::{SourceLocation, Sources};

/// Result of the check of block names: the earlier events that each event and each `after` depend
/// on.
#[derive(Clone, Debug)]
pub struct Liveness {
    /// For each event, the events that it depends on through the names of its blocks.
    pub contexts: Vec<EventContext>,
    /// Events that the `after` clauses name, in the order of the clauses. `None` for an event of an
    /// earlier phase.
    pub subjects: Vec<Option<EventId>>,
}

/// Events of the same phase that an event depends on through the names of its blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct EventContext {
    /// Capture of this phase that attaches the parent of a capture, or the block of a release.
    /// `None` if that block was attached before the phase.
    pub anchored_by: Option<EventId>,
    /// Release of this phase that frees the name that a capture uses. `None` if the name was free.
    pub freed_by: Option<EventId>,
}

/// A block that has a name in one phase.
///
/// A name may have two holders in a phase: the block at the start, and a block captured after the
/// release of the first. The two blocks observe different events.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Holder {
    /// Name of the block.
    pub role: RoleId,
    /// Capture of this phase that attached the block. `None` if the block is attached when the
    /// phase starts.
    pub since: Option<EventId>,
}

impl Holder {
    /// Returns the block that has a name when the phase starts.
    pub fn existing(role: RoleId) -> Holder {
        Holder { role, since: None }
    }

    /// Returns the block of a capture of this phase.
    pub fn captured(role: RoleId, capture: EventId) -> Holder {
        let since = Some(capture);
        Holder { role, since }
    }

    /// Returns the trigger of the block's duty: the start of the phase, or the block's capture.
    pub fn trigger(self) -> Trigger {
        match self.since {
            Some(_) => Trigger::Anchored,
            None => Trigger::Start,
        }
    }
}

impl Liveness {
    /// Returns the acting block: the capturing block, or the released block.
    pub fn actor(&self, plan: &ExpandedProgram, id: EventId) -> Holder {
        Holder {
            role: plan.actor(id),
            since: self.contexts[id.0 as usize].anchored_by,
        }
    }
}

#[derive(Clone, Copy, Default)]
struct RoleLiveness {
    /// Origin of the block that has the name. `None` if no block has it.
    holder: Option<BlockOrigin>,
    /// Number of the phase that the next two fields describe, from 1.
    phase: u32,
    captured: Option<EventId>,
    released: Option<EventId>,
    /// Last release of the name in any phase.
    last_release: Option<EventId>,
}

#[derive(Clone, Copy, PartialEq)]
enum BlockOrigin {
    Seed,
    Capture(EventId),
}

/// Checks every name, and marks invalid events in the plan.
///
/// `attracts` states whether faces attract by themselves. Unused seeds then have an effect.
///
/// # Errors
///
/// Returns [`Cancelled`] if the check was cancelled.
pub fn check(
    plan: &mut ExpandedProgram,
    sources: &Sources,
    symbols: &Symbols,
    uncertain: &FxHashSet<Symbol>,
    attracts: bool,
    cancellation: Cancellation<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<Liveness, Cancelled> {
    let mut checker = Checker {
        states: vec![RoleLiveness::default(); plan.roles.count()],
        used: vec![false; plan.seeds.len()],
        liveness: Liveness {
            contexts: vec![EventContext::default(); plan.events.len()],
            subjects: vec![None; plan.afters.len()],
        },
        sources,
        symbols,
        uncertain,
        attracts,
        diagnostics,
        first_captures: None,
        plan,
    };
    checker.run(cancellation)?;
    Ok(checker.liveness)
}

/// The earlier event or seed that already uses the name of a captured block.
#[derive(Clone, Copy)]
enum Earlier {
    /// A seed, declared at this location.
    Seeded(SourceLocation),
    /// A capture of the same phase.
    Captured(EventId),
    /// A capture of an earlier phase.
    Attached(EventId),
}

struct Checker<'a> {
    plan: &'a mut ExpandedProgram,
    states: Vec<RoleLiveness>,
    /// Whether each seed is used.
    used: Vec<bool>,
    liveness: Liveness,
    sources: &'a Sources,
    symbols: &'a Symbols,
    uncertain: &'a FxHashSet<Symbol>,
    attracts: bool,
    diagnostics: &'a mut Vec<Diagnostic>,
    /// First capture of every block, computed on demand.
    first_captures: Option<FxHashMap<RoleId, EventId>>,
}

impl Checker<'_> {
    fn run(&mut self, cancellation: Cancellation<'_>) -> Result<(), Cancelled> {
        for i in 0..self.plan.seeds.len() {
            let role = self.plan.seeds[i].role;
            self.states[role.0 as usize].holder = Some(BlockOrigin::Seed);
        }
        let mut afters = 0;
        for number in 0..self.plan.phases.len() {
            let stamp = number as u32 + 1;
            let events: Vec<EventId> = self.plan.events_of(&self.plan.phases[number]).collect();
            for &event in &events {
                cancellation.check()?;
                self.enter(event, stamp);
            }
            for &event in &events {
                cancellation.check()?;
                self.resolve(event, stamp);
            }
            let end = self.plan.phases[number].events.end;
            while self
                .plan
                .afters
                .get(afters)
                .is_some_and(|after| after.event.0 < end)
            {
                cancellation.check()?;
                self.resolve_after(afters, stamp);
                afters += 1;
            }
            for &event in &events {
                self.leave(event);
            }
        }
        self.keep_needed_afters();
        // A program without phases has its own warning.
        if self.plan.phases.iter().all(|phase| phase.pre_attached) {
            return Ok(());
        }
        for (seed, used) in self.plan.seeds.iter().zip(&self.used) {
            let key = self.plan.roles.key(seed.role);
            if is_full(self.diagnostics, Severity::Warning) {
                break;
            }
            if !used && !self.is_uncertain_word(key.word) {
                let name = self.plan.roles.name(seed.role, self.symbols);
                let mut diagnostic = Diagnostic::about(
                    Code::UnusedSeed,
                    "seed `{}` is never used",
                    &[&name],
                )
                .label(seed.location, "this seed captures nothing")
                .help(if self.attracts {
                    "let it capture a block; without its name, the plate attracts no blocks there"
                } else {
                    "let it capture a block, or remove its name: the plate stays the same"
                });
                // A statement in a loop declares several seeds, and the others may be used.
                let alone = named(self.sources, seed.location, &name);
                let is_idle = alone.is_some() && !self.attracts;
                if let Some(statement) = seed.statement.filter(|_| is_idle) {
                    let location = removal(self.sources, statement);
                    diagnostic.fix =
                        Some(Fix::remove(location, format!("remove the seed `{name}`")));
                }
                report(self.diagnostics, diagnostic);
            }
        }
        Ok(())
    }

    /// Removes warnings about an unneeded `after` if another round of its loop or another instance
    /// of its pattern needs it.
    fn keep_needed_afters(&mut self) {
        let is_redundant = |diagnostic: &Diagnostic| diagnostic.code == Code::RedundantAfter;
        if !self.diagnostics.iter().any(is_redundant) {
            return;
        }
        let place = |location: SourceLocation| (location.file, location.span.start);
        let needed: FxHashSet<_> = (self.plan.afters.iter().zip(&self.liveness.subjects))
            .filter(|(_, subject)| subject.is_some())
            .map(|(after, _)| place(after.location))
            .collect();
        self.diagnostics.retain(|diagnostic| {
            let is_needed = || needed.contains(&place(diagnostic.labels[0].location));
            !is_redundant(diagnostic) || !is_needed()
        });
    }

    fn state(&mut self, role: RoleId, stamp: u32) -> &mut RoleLiveness {
        let state = &mut self.states[role.0 as usize];
        if state.phase != stamp {
            state.phase = stamp;
            state.captured = None;
            state.released = None;
        }
        state
    }

    /// Records a capture or a release in the state of its name for the current phase.
    fn enter(&mut self, id: EventId, stamp: u32) {
        let event = *self.plan.event(id);
        let state = *self.state(event.role, stamp);
        let seed = state.holder == Some(BlockOrigin::Seed);
        match event.kind {
            EventKind::Capture { parent, .. } => {
                self.use_seed(parent);
                if let Some(first) = state.captured {
                    self.captured_twice(id, Earlier::Captured(first));
                } else if seed {
                    let location = self.plan.seeds[event.role.0 as usize].location;
                    self.captured_twice(id, Earlier::Seeded(location));
                } else {
                    self.state(event.role, stamp).captured = Some(id);
                }
            }
            EventKind::Release => {
                self.use_seed(event.role);
                if let Some(first) = state.released {
                    self.released_twice(id, first);
                } else if seed {
                    self.released_seed(id, event.role);
                } else {
                    self.state(event.role, stamp).released = Some(id);
                }
            }
        }
    }

    fn use_seed(&mut self, role: RoleId) {
        if let Some(used) = self.used.get_mut(role.0 as usize) {
            *used = true;
        }
    }

    /// Resolves the names of an event against all events of its phase.
    fn resolve(&mut self, id: EventId, stamp: u32) {
        let event = *self.plan.event(id);
        if !event.valid {
            return;
        }
        let state = *self.state(event.role, stamp);
        let context = match event.kind {
            EventKind::Capture { parent, .. } => {
                let freed_by = match (state.holder, state.released) {
                    (Some(_), Some(release)) => Some(release),
                    (Some(BlockOrigin::Capture(_)), None) if self.plan.is_uncertain(event.role) => {
                        self.plan.events[id.0 as usize].valid = false;
                        return;
                    }
                    (Some(BlockOrigin::Capture(first)), None) => {
                        return self.captured_twice(id, Earlier::Attached(first));
                    }
                    _ => None,
                };
                let parent_state = *self.state(parent, stamp);
                if parent_state.holder.is_none() && parent_state.captured.is_none() {
                    return self.absent(id, parent, parent_state);
                }
                EventContext {
                    anchored_by: parent_state.captured,
                    freed_by,
                }
            }
            EventKind::Release => {
                if state.holder.is_none() && state.captured.is_none() {
                    return self.absent(id, event.role, state);
                }
                let anchored_by = match state.holder {
                    Some(_) => None,
                    None => state.captured,
                };
                EventContext {
                    anchored_by,
                    freed_by: None,
                }
            }
        };
        self.liveness.contexts[id.0 as usize] = context;
    }

    fn resolve_after(&mut self, number: usize, stamp: u32) {
        let after = self.plan.afters[number];
        self.use_seed(after.role);
        let state = *self.state(after.role, stamp);
        let subject = if after.release {
            state.released
        } else {
            state.captured
        };
        if subject.is_some() {
            self.liveness.subjects[number] = subject;
            return;
        }
        if is_full(self.diagnostics, Severity::Error) || self.is_uncertain(after.role) {
            return;
        }
        let name = self.plan.roles.name(after.role, self.symbols);
        let diagnostic = if after.release {
            Diagnostic::about(
                Code::AbsentBlock,
                "`{}` is not released in this phase",
                &[&name],
            )
            .label(after.location, "this release never happens")
            .help(format!(
                "release `{name}` in this phase, or remove it from the `after`"
            ))
        } else if state.holder.is_some() {
            if is_full(self.diagnostics, Severity::Warning) {
                return;
            }
            let format = "`{}` is attached before this phase starts";
            let mut diagnostic = Diagnostic::about(Code::RedundantAfter, format, &[&name])
                .label(after.location, "this `after` waits for nothing");
            // A release cannot wait for itself.
            let is_released = state.released.is_some_and(|event| event != after.event);
            if is_released {
                diagnostic = diagnostic.help(format!(
                    "write `after release {name}` to wait until it is gone"
                ));
            }
            // The name must be written in full. In a loop or a pattern, it may stand for other
            // blocks.
            if named(self.sources, after.location, &name) == Some(after.location) {
                let drop =
                    |location| Fix::remove(location, format!("remove `{name}` from the `after`"));
                let fix = entry(self.sources, after.location, "after").map(drop);
                diagnostic.fix = fix.map(|fix| fix.unsafe_if(is_released));
            }
            diagnostic
        } else {
            let format = "`{}` is not captured in this phase";
            let diagnostic = Diagnostic::about(Code::AbsentBlock, format, &[&name])
                .label(after.location, "this `after` would wait forever");
            let later = self.first_captures().get(&after.role).copied();
            let help = match later {
                Some(capture) => format!(
                    "move this statement to phase `{}`, or remove `{name}` from the `after`",
                    self.plan.phase_name(capture)
                ),
                None => format!("capture `{name}` in this phase, or remove it from the `after`"),
            };
            match self.unknown(after.role, after.location, state, diagnostic, help) {
                Some(diagnostic) => diagnostic,
                None => return,
            }
        };
        report(self.diagnostics, diagnostic);
    }

    /// Applies an event of the completed phase to the state of its name.
    fn leave(&mut self, id: EventId) {
        let event = *self.plan.event(id);
        if !event.valid {
            return;
        }
        let context = self.liveness.contexts[id.0 as usize];
        let state = &mut self.states[event.role.0 as usize];
        match event.kind {
            // If a name is released and captured again, a block has it at the end. In the other
            // order, none has it.
            EventKind::Capture { .. } => {
                if state.released.is_none() || context.freed_by.is_some() {
                    state.holder = Some(BlockOrigin::Capture(id));
                }
            }
            EventKind::Release => {
                state.last_release = Some(id);
                let taken_again = context.anchored_by.is_none() && state.captured.is_some();
                if !taken_again {
                    state.holder = None;
                }
            }
        }
    }

    /// Marks an event as invalid. Returns `false` if the limit of errors is reached. The error of
    /// the event is then not reported.
    fn reject(&mut self, id: EventId) -> bool {
        self.plan.events[id.0 as usize].valid = false;
        !is_full(self.diagnostics, Severity::Error)
    }

    fn captured_twice(&mut self, id: EventId, earlier: Earlier) {
        if !self.reject(id) {
            return;
        }
        let event = self.plan.event(id);
        let name = self.plan.roles.name(event.role, self.symbols);
        let other = match earlier {
            Earlier::Seeded(location) => location,
            Earlier::Captured(first) | Earlier::Attached(first) => self.plan.event(first).location,
        };
        let phase = self.plan.phase_name(id);
        let about =
            |format, subjects: &[&str]| Diagnostic::about(Code::CapturedTwice, format, subjects);
        let (diagnostic, labels) = match earlier {
            Earlier::Seeded(_) => (
                about("`{}` is a seed and cannot be captured", &[&name]),
                ["captured here", "declared as a seed"],
            ),
            Earlier::Captured(_) => (
                about("`{}` is captured twice in phase `{}`", &[&name, phase]),
                ["second capture", "first capture"],
            ),
            Earlier::Attached(_) => (
                about("`{}` is captured again while it is attached", &[&name]),
                ["second capture", "first capture, never released"],
            ),
        };
        let written = last_named(self.sources, event.location, &name);
        let new = self.unused_name(event.role);
        let rename = written.filter(|_| event.location != other).zip(new);
        let mut help = match &rename {
            Some((_, new)) => format!("give the new block another name, such as `{new}`"),
            None if event.location == other => {
                "give each block its own name, with the counter of the loop as index: `A[i]`"
                    .to_owned()
            }
            None => "give the new block another name".to_owned(),
        };
        if matches!(earlier, Earlier::Attached(_)) {
            help += &format!(", or release `{name}` first");
        }
        let mut diagnostic = diagnostic
            .label(event.location, labels[0])
            .label(other, labels[1])
            .help(help);
        diagnostic.fix = rename.map(|(location, new)| {
            Fix::replace(location, &new, format!("call it `{new}`")).unsafe_if(true)
        });
        report(self.diagnostics, diagnostic);
    }

    /// Returns a similar name that no block has. Returns `None` inside a pattern.
    fn unused_name(&self, role: RoleId) -> Option<String> {
        let key = self.plan.roles.key(role);
        if key.scope != 0 || key.arity != 0 {
            return None;
        }
        let word = self.symbols.word(key.word);
        let is_unused = |name: &String| self.symbols.get(name).is_none();
        (2..100)
            .map(|number| format!("{word}_{number}"))
            .find(is_unused)
    }

    fn released_twice(&mut self, id: EventId, first: EventId) {
        if !self.reject(id) {
            return;
        }
        let event = self.plan.event(id);
        let name = self.plan.roles.name(event.role, self.symbols);
        let phase = self.plan.phase_name(id);
        let format = "`{}` is released twice in phase `{}`";
        let mut diagnostic = Diagnostic::about(Code::ReleasedTwice, format, &[&name, phase])
            .label(event.location, "second release")
            .label(self.plan.event(first).location, "first release")
            .help(format!("remove the second release of `{name}`"));
        diagnostic.fix = self.without_release(event.location, &name);
        report(self.diagnostics, diagnostic);
    }

    fn released_seed(&mut self, id: EventId, role: RoleId) {
        if !self.reject(id) {
            return;
        }
        let name = self.plan.roles.name(role, self.symbols);
        let format = "`{}` is a seed and cannot be released";
        let location = self.plan.event(id).location;
        let mut diagnostic = Diagnostic::about(Code::ReleasedSeed, format, &[&name])
            .label(location, "released here")
            .label(
                self.plan.seeds[role.0 as usize].location,
                "declared as a seed",
            )
            .help(format!("remove `{name}` from the release"));
        diagnostic.fix = self.without_release(location, &name);
        report(self.diagnostics, diagnostic);
    }

    /// Returns a fix that removes a block from a release. Returns `None` if the source names
    /// several blocks at once.
    fn without_release(&self, location: SourceLocation, name: &str) -> Option<Fix> {
        let is_alone = named(self.sources, location, name) == Some(location);
        let removed = entry(self.sources, location, "release").filter(|_| is_alone)?;
        let title = format!("remove `{name}` from the release");
        Some(Fix::remove(removed, title).unsafe_if(true))
    }

    /// Reports an event whose acting block is not attached.
    fn absent(&mut self, id: EventId, role: RoleId, state: RoleLiveness) {
        self.plan.events[id.0 as usize].valid = false;
        if is_full(self.diagnostics, Severity::Error) {
            return;
        }
        if self.is_uncertain(role) {
            // The event's own block may therefore be missing too.
            let own = self.plan.roles.key(self.plan.event(id).role).word;
            self.plan.uncertain.insert(own);
            return;
        }
        let location = self.plan.event(id).location;
        let name = self.plan.roles.name(role, self.symbols);
        let code = match self.plan.event(id).kind {
            EventKind::Release => Code::ReleasedAbsent,
            EventKind::Capture { .. } => Code::AbsentBlock,
        };
        let phase = self.plan.phase_name(id);
        let verb = match code {
            Code::ReleasedAbsent => "released again",
            _ => "used",
        };
        let (format, help) = match (state.last_release, code) {
            (Some(_), Code::ReleasedAbsent) => (
                "`{}` was already released",
                format!("remove this release, or capture `{name}` again first"),
            ),
            (Some(_), _) => (
                "`{}` is used after it was released",
                format!("capture `{name}` again first, or use another block"),
            ),
            (None, Code::ReleasedAbsent) => (
                "`{}` is released before it is captured",
                format!("capture `{name}` in phase `{phase}` or earlier"),
            ),
            (None, _) => (
                "`{}` is used before it is captured",
                format!("capture `{name}` in phase `{phase}` or earlier"),
            ),
        };
        let diagnostic = Diagnostic::about(code, format, &[&name])
            .label(location, format!("{verb} in phase `{phase}`"));
        let mut known = self.unknown(role, location, state, diagnostic, help);
        if let Some(diagnostic) = &mut known
            && diagnostic.code == Code::ReleasedAbsent
        {
            diagnostic.fix = self.without_release(location, &name);
        }
        if let Some(diagnostic) = known {
            report(self.diagnostics, diagnostic);
        }
    }

    /// Returns whether an unreadable part of the program may capture this name, so that the name
    /// may exist.
    fn is_uncertain(&self, role: RoleId) -> bool {
        let key = self.plan.roles.key(role);
        let mut scopes =
            std::iter::successors(Some(key.scope), |&scope| self.plan.roles.outer(scope));
        self.is_uncertain_word(key.word)
            || scopes.any(|scope| self.grown(scope).is_some_and(|grown| grown.is_uncertain))
    }

    fn is_uncertain_word(&self, word: Symbol) -> bool {
        self.uncertain.contains(&word) || self.plan.uncertain.contains(&word)
    }

    fn grown(&self, scope: u32) -> Option<PatternInstance> {
        let number = (scope as usize).checked_sub(1)?;
        self.plan.grown.get(number).copied()
    }

    fn first_captures(&mut self) -> &FxHashMap<RoleId, EventId> {
        self.first_captures.get_or_insert_with(|| {
            let mut first = FxHashMap::default();
            for (number, event) in self.plan.events.iter().enumerate() {
                if matches!(event.kind, EventKind::Capture { .. }) {
                    first.entry(event.role).or_insert(EventId(number as u32));
                }
            }
            first
        })
    }

    /// Completes the diagnostic of a name without a block. The name is unknown, or its block is in
    /// another phase. `help` is the help for a block of another phase. Returns `None` if the
    /// statement has been reported.
    fn unknown(
        &mut self,
        role: RoleId,
        location: SourceLocation,
        state: RoleLiveness,
        mut diagnostic: Diagnostic,
        help: String,
    ) -> Option<Diagnostic> {
        if let Some(release) = state.last_release {
            let label = format!("released in phase `{}`", self.plan.phase_name(release));
            let location = self.plan.event(release).location;
            return Some(diagnostic.label(location, label).help(help));
        }
        if let Some(&capture) = self.first_captures().get(&role) {
            let label = format!("captured in phase `{}`", self.plan.phase_name(capture));
            let location = self.plan.event(capture).location;
            return Some(diagnostic.label(location, label).help(help));
        }
        diagnostic.code = Code::UnknownName;
        if let Some(diagnostic) = self.around(role, location) {
            return Some(diagnostic);
        }
        let name = self.plan.roles.name(role, self.symbols);
        let labels = std::mem::take(&mut diagnostic.labels);
        let mut diagnostic =
            Diagnostic::about(Code::UnknownName, "cannot find block `{}`", &[&name]);
        diagnostic.labels = labels;
        if let Some(label) = diagnostic.labels.first_mut() {
            "no seed or capture has this name".clone_into(&mut label.text);
        }
        // The search for similar names is slow.
        if is_repeated(self.diagnostics, &diagnostic) {
            return None;
        }
        let key = self.plan.roles.key(role);
        if let Some(absent) = self.plan.branches.absent(key.word) {
            let label = "captured or declared in a branch that is not taken";
            return Some(
                diagnostic
                    .label(absent, label)
                    .help("check the condition of the branch"),
            );
        }
        let roles = &self.plan.roles;
        if let Some(members) = members(key, self.blocks(), roles, self.symbols) {
            return Some(diagnostic.help(members.describe("block")));
        }
        let known = self.blocks().take(2_000);
        let known = known.map(|key| roles.name_of(key, self.symbols));
        let written = named(self.sources, location, &name);
        diagnostic =
            diagnostic.suggest(location, suggestion(self.diagnostics, &name, known), || {
                format!("add it to the seed plate, or capture it: `... -> {name}`").to_owned()
            });
        // A name with a computed index is written differently.
        diagnostic.fix = diagnostic.fix.zip(written).map(|(mut fix, location)| {
            fix.edits
                .iter_mut()
                .for_each(|edit| edit.location = location);
            fix
        });
        Some(diagnostic)
    }

    /// Returns the names of all seeds and captured blocks.
    fn blocks(&self) -> impl Iterator<Item = NameKey> {
        let captured = (self.plan.events.iter())
            .filter(|event| matches!(event.kind, EventKind::Capture { .. }))
            .map(|event| event.role);
        let seeds = self.plan.seeds.iter().map(|seed| seed.role);
        (seeds.chain(captured)).map(|role| self.plan.roles.key(role))
    }

    /// Returns an error if a pattern uses a block from outside of the pattern.
    fn around(&mut self, role: RoleId, location: SourceLocation) -> Option<Diagnostic> {
        let key = self.plan.roles.key(role);
        let grown = self.grown(key.scope)?;
        // In other patterns, the name of the instance comes before the block's name.
        let word = self.symbols.word(key.word);
        let behind = self.sources.text(location).strip_prefix(word)?;
        if behind.starts_with(|c: char| c.is_ascii_alphanumeric() || c == '_') {
            return None;
        }
        let (roles, seeds) = (&self.plan.roles, self.plan.seeds.len());
        let outer = std::iter::successors(roles.outer(key.scope), |&scope| roles.outer(scope));
        let candidates: Vec<(u32, RoleId)> = outer
            .filter_map(|scope| Some((scope, roles.get(&key.within(scope))?)))
            .collect();
        let is_seed = |role: RoleId| (role.0 as usize) < seeds;
        let captures = self.first_captures();
        let is_block = |role: RoleId| is_seed(role) || captures.contains_key(&role);
        let (_, known) = candidates.into_iter().find(|&(_, role)| is_block(role))?;
        let there = match self.first_captures().get(&known) {
            Some(&capture) => (
                self.plan.event(capture).location,
                "captured outside the pattern",
            ),
            None => (
                self.plan.seeds[known.0 as usize].location,
                "declared outside the pattern",
            ),
        };
        let block = self.plan.roles.name_of(key.within(0), self.symbols);
        let pattern = self.symbols.word(grown.pattern);
        let format = "pattern `{}` cannot use the block `{}`";
        let diagnostic = Diagnostic::about(Code::UnknownName, format, &[pattern, &block])
            .label(location, "unknown inside the pattern")
            .label(there.0, there.1)
            .help(parameter_hint(self.sources, &grown, word, &block));
        Some(diagnostic)
    }
}
