//! A program with its patterns and loops written out: a flat list of captures and releases.
use rustc_hash::{FxHashMap, FxHashSet};
use stochc_grammar::tree::Quantity;
use stochc_grammar::{Symbol, Symbols};
use stochc_ir::graph::EventAction;
pub use stochc_ir::graph::EventId;
use stochc_ir::scene::units::Dimension;
use stochc_ir::table::{Plate, RoleId};
use stochc_ir::{Cell, Face};

use crate::SourceLocation;
use crate::units::to_si;

/// A program, written out.
#[derive(Clone, Debug)]
pub struct ProgramPlan {
    /// Its name.
    pub name: String,
    /// Where that stands.
    pub location: SourceLocation,
    /// The seed plate.
    pub plate: Plate,
    /// The seeds, in source order.
    pub seeds: Vec<PlanSeed>,
    /// Every name of a block.
    pub roles: Roles,
    /// The phases, in order.
    pub phases: Vec<PlanPhase>,
    /// Captures and releases in source order, phase by phase.
    pub events: Vec<PlanEvent>,
    /// The orders that `after` adds, sorted by the event that waits.
    pub afters: Vec<AfterConstraint>,
    /// Of an aggregate, the blocks of a group with which it is complete. It has no plate, no seeds and
    /// no events, and a phase for each size from two on.
    pub aggregate: Option<u32>,
    /// The instances of patterns, by their scope: that of [`NameKey::scope`] 1 comes first.
    pub grown: Vec<PatternInstance>,
    /// Statements that were looked at to write it out.
    pub(crate) steps: usize,
    /// The words of blocks and instances that may be missing, or gone, because a statement could not be worked out.
    pub doubtful: FxHashSet<Symbol>,
}

impl ProgramPlan {
    /// The number of the phase that an event belongs to; `None`: it stands where it does not belong, in none.
    pub fn phase_of(&self, event: EventId) -> Option<usize> {
        let ended = |phase: &PlanPhase| phase.events.end <= event.0;
        let number = self.phases.partition_point(ended);
        let phase = self.phases.get(number)?;
        phase.events.contains(&event.0).then_some(number)
    }

    /// Whether a block may be missing, or gone, because a statement could not be worked out.
    pub(crate) fn is_doubtful(&self, role: RoleId) -> bool {
        self.doubtful.contains(&self.roles.key(role).word)
    }

    /// What the phase of an event is called; nothing, if it is in none.
    pub fn phase_name(&self, event: EventId) -> &str {
        let phase = self.phase_of(event);
        phase.map_or("", |number| &self.phases[number].name)
    }
}

/// An instance of a pattern.
#[derive(Clone, Copy, Debug)]
pub struct PatternInstance {
    /// The name of the pattern.
    pub pattern: Symbol,
    /// Where that is declared.
    pub declared: SourceLocation,
    /// The statement that grows it, without the name of the instance.
    pub call: SourceLocation,
    /// Whether it has been given what could not be worked out, so that blocks may be missing in it.
    pub is_doubtful: bool,
}

/// A block of the plate that has a name.
#[derive(Clone, Copy, Debug)]
pub struct PlanSeed {
    /// Its name.
    pub role: RoleId,
    /// Its cell, with z = 0.
    pub cell: Cell,
    /// Where it is named.
    pub location: SourceLocation,
    /// The whole statement, if no comments belong to it.
    pub statement: Option<SourceLocation>,
}

/// A phase, written out.
#[derive(Clone, Debug)]
pub struct PlanPhase {
    /// Its name.
    pub name: String,
    /// Where that stands.
    pub location: SourceLocation,
    /// Ticks or seconds after which it has failed.
    pub timeout: Option<Timeout>,
    /// Its events, a range of [`ProgramPlan::events`].
    pub events: std::ops::Range<u32>,
    /// Whether its blocks are attached by hand before anything moves; only the first phase may be.
    pub planted: bool,
    /// The shape it claims, with the place of the claim.
    pub claims: Vec<(Symbol, SourceLocation)>,
}

/// How long a phase may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Timeout {
    /// In ticks of the scene's clock.
    Ticks(u64),
    /// In seconds.
    Seconds(f64),
}

impl Timeout {
    /// Beyond this a double does not count ticks one by one.
    const MAX_TICKS: f64 = 9e15;

    /// The time that a quantity stands for, if it is a positive time.
    pub fn from_quantity(quantity: &Quantity) -> Option<Timeout> {
        let (value, dimension) = to_si(quantity);
        match dimension {
            Dimension::TICKS
                if (1.0..Timeout::MAX_TICKS).contains(&value) && value.fract() == 0.0 =>
            {
                Some(Timeout::Ticks(value as u64))
            }
            Dimension::TIME if value > 0.0 => Some(Timeout::Seconds(value)),
            _ => None,
        }
    }

    /// Whether a quantity is in ticks.
    pub fn is_in_ticks(quantity: &Quantity) -> bool {
        to_si(quantity).1 == Dimension::TICKS
    }

    /// Whether a quantity is in ticks, or a time.
    pub fn is_a_time(quantity: &Quantity) -> bool {
        [Dimension::TICKS, Dimension::TIME].contains(&to_si(quantity).1)
    }

    /// In ticks of a clock \[s\], at least one and at most 9e15.
    pub fn ticks(self, tick: f64) -> u64 {
        match self {
            Timeout::Ticks(ticks) => ticks,
            Timeout::Seconds(seconds) => {
                (seconds / tick).round().clamp(1.0, Timeout::MAX_TICKS) as u64
            }
        }
    }
}

/// A capture or a release.
#[derive(Clone, Copy, Debug)]
pub struct PlanEvent {
    /// Which of the two.
    pub kind: EventKind,
    /// The block that is captured or released.
    pub role: RoleId,
    /// Where it is written.
    pub location: SourceLocation,
    /// Whether it makes sense; a senseless event has been told of, and takes no further part.
    pub sound: bool,
}

/// What an event does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// A block magnetizes a face and names what docks there.
    Capture {
        /// The block that does.
        parent: RoleId,
        /// Through this face, in the structure's frame.
        face: Face,
    },
    /// A block asks its parent to let it go.
    Release,
}

/// An order that the program adds.
#[derive(Clone, Copy, Debug)]
pub struct AfterConstraint {
    /// What waits.
    pub event: EventId,
    /// For whom.
    pub role: RoleId,
    /// Whether for its release rather than its capture.
    pub release: bool,
    /// Where it is written.
    pub location: SourceLocation,
}

/// A name without its text: the instance of a pattern it belongs to, a word, and indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NameKey {
    /// Which instance; 0 is the program itself.
    pub scope: u32,
    /// The word.
    pub word: Symbol,
    /// How many of the indices count.
    pub arity: u8,
    /// The indices.
    pub index: [i32; NameKey::MAX_INDICES],
}

impl NameKey {
    /// Indices that a name may have.
    pub const MAX_INDICES: usize = 3;

    /// The same name in another scope.
    #[must_use]
    pub fn within(self, scope: u32) -> NameKey {
        NameKey { scope, ..self }
    }
}

/// Every name of a block, and every named instance of a pattern.
#[derive(Clone, Debug, Default)]
pub struct Roles {
    roles: FxHashMap<NameKey, RoleId>,
    keys: Vec<NameKey>,
    scopes: FxHashMap<NameKey, u32>,
    scope_keys: Vec<NameKey>,
}

impl Roles {
    /// The role of a name, new or known.
    pub fn intern(&mut self, key: NameKey) -> RoleId {
        let next = RoleId(self.keys.len() as u32);
        let role = *self.roles.entry(key).or_insert(next);
        if role == next {
            self.keys.push(key);
        }
        role
    }

    /// The role of a name, if known.
    pub fn get(&self, key: &NameKey) -> Option<RoleId> {
        self.roles.get(key).copied()
    }

    /// How many names there are.
    pub fn count(&self) -> usize {
        self.keys.len()
    }

    /// The name of a role, without its text.
    pub fn key(&self, role: RoleId) -> NameKey {
        self.keys[role.0 as usize]
    }

    /// The names that lead to a role: the instances of patterns that hold it, the outermost first, and
    /// its own.
    pub fn path(&self, role: RoleId) -> Vec<NameKey> {
        let mut path = vec![self.key(role)];
        while let Some(&NameKey { scope: 1.., .. }) = path.last() {
            let scope = path[path.len() - 1].scope;
            path.push(self.scope_keys[scope as usize - 1]);
        }
        path.reverse();
        path
    }

    /// The pattern of which an instance without a name holds a role, so that nothing in the program can name that.
    pub fn nameless<'s>(&self, role: RoleId, symbols: &'s Symbols) -> Option<&'s str> {
        let path = self.path(role).into_iter();
        let mut patterns = path.filter_map(|key| symbols.word(key.word).split_once('#'));
        patterns.next().map(|(pattern, _)| pattern)
    }

    /// The scope of an instance, new or known.
    pub fn intern_scope(&mut self, key: NameKey) -> u32 {
        let next = self.scope_keys.len() as u32 + 1;
        let scope = *self.scopes.entry(key).or_insert(next);
        if scope == next {
            self.scope_keys.push(key);
        }
        scope
    }

    /// The scope of an instance, if known.
    pub fn scope(&self, key: &NameKey) -> Option<u32> {
        self.scopes.get(key).copied()
    }

    /// The names of the instances in a scope, without their texts.
    pub fn instances(&self, scope: u32) -> impl Iterator<Item = NameKey> {
        let all = self.scope_keys.iter().copied();
        all.filter(move |key| key.scope == scope)
    }

    /// The scope around that of an instance; `None`: around the program itself is nothing.
    pub fn outer(&self, scope: u32) -> Option<u32> {
        let key = self.scope_keys.get((scope as usize).checked_sub(1)?)?;
        Some(key.scope)
    }

    /// A name as the program writes it, such as `a.T[2]`.
    pub fn name(&self, role: RoleId, symbols: &Symbols) -> String {
        self.name_of(self.key(role), symbols)
    }

    /// The name that a key stands for.
    pub fn name_of(&self, key: NameKey, symbols: &Symbols) -> String {
        let mut text = String::new();
        self.write(key, symbols, &mut text);
        text
    }

    fn write(&self, key: NameKey, symbols: &Symbols, text: &mut String) {
        use std::fmt::Write as _;
        // The depth of scopes is bounded by the depth of the expansion.
        let scope = (key.scope as usize).checked_sub(1);
        // While it is only counted what there will be, scopes have no keys.
        if let Some(&outer) = scope.and_then(|scope| self.scope_keys.get(scope)) {
            self.write(outer, symbols, text);
            text.push('.');
        }
        text.push_str(symbols.word(key.word));
        for (i, index) in key.index[..key.arity as usize].iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(text, "{}{index}", if i == 0 { "[" } else { ", " });
        }
        if key.arity > 0 {
            text.push(']');
        }
    }
}

impl PlanEvent {
    /// What happens, without its text.
    pub fn action(&self) -> EventAction {
        let child = self.role;
        match self.kind {
            EventKind::Capture { parent, face } => EventAction::Capture {
                parent,
                face,
                child,
            },
            EventKind::Release => EventAction::Release { child },
        }
    }
}

impl ProgramPlan {
    /// Forgets what has been written out, and keeps the plate.
    pub(crate) fn clear(&mut self) {
        self.seeds = Vec::new();
        self.roles = Roles::default();
        self.phases = Vec::new();
        self.events = Vec::new();
        self.afters = Vec::new();
    }

    /// An event.
    pub fn event(&self, id: EventId) -> &PlanEvent {
        &self.events[id.0 as usize]
    }

    /// The name of the block that an event is up to: the one that captures, or the one that asks to be let go.
    pub(crate) fn actor(&self, id: EventId) -> RoleId {
        let event = self.event(id);
        match event.kind {
            EventKind::Capture { parent, .. } => parent,
            EventKind::Release => event.role,
        }
    }

    /// The events of a phase, by number.
    pub fn events_of(&self, phase: &PlanPhase) -> impl Iterator<Item = EventId> + use<> {
        phase.events.clone().map(EventId)
    }

    /// How many captures and how many releases there are.
    pub fn counts(&self) -> (usize, usize) {
        let releases = (self.events.iter())
            .filter(|event| event.kind == EventKind::Release)
            .count();
        (self.events.len() - releases, releases)
    }

    /// Returns how many blocks are attached before the run starts.
    pub fn pre_attached(&self) -> usize {
        let planted = self.phases.iter().filter(|phase| phase.planted);
        planted.map(|phase| phase.events.len()).sum()
    }

    /// An event in a few words: `A.up -> E`, or `release E`.
    pub fn describe(&self, id: EventId, symbols: &Symbols) -> String {
        let action = self.event(id).action();
        action.describe(|role| self.roles.name(role, symbols))
    }
}
