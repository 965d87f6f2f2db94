//! An expanded program: a flat list of captures and releases.
use rustc_hash::{FxHashMap, FxHashSet};
use stochc_grammar::tree::Quantity;
use stochc_grammar::{Symbol, Symbols};
use stochc_ir::claim::Relation;
use stochc_ir::graph::EventAction;
pub use stochc_ir::graph::EventId;
use stochc_ir::scene::units::Dimension;
use stochc_ir::table::{Plate, RoleId};
use stochc_ir::{Cell, Face};

use crate::SourceLocation;
use crate::expand::branches::Branches;
use crate::expand::units::to_si;

/// A program with loops and patterns expanded.
#[derive(Clone, Debug)]
pub struct ExpandedProgram {
    /// Name of the program.
    pub name: String,
    /// Location of the name.
    pub location: SourceLocation,
    /// Parameters with their values, in source order.
    pub parameters: Vec<(String, i64)>,
    /// Seed plate.
    pub plate: Plate,
    /// Seeds in source order.
    pub seeds: Vec<ExpandedSeed>,
    /// Names of all blocks.
    pub roles: Roles,
    /// Phases in order.
    pub phases: Vec<ExpandedPhase>,
    /// Captures and releases in source order, phase by phase.
    pub events: Vec<ExpandedEvent>,
    /// Dependencies that `after` declares, sorted by the waiting event.
    pub afters: Vec<AfterConstraint>,
    /// Times that releases wait, sorted by the release.
    pub delays: Vec<ReleaseDelay>,
    /// Number of blocks in a complete aggregate. `None` for an assembly. An aggregate has no plate,
    /// seeds or events. It has one phase for each size of 2 or more blocks.
    pub aggregate: Option<u32>,
    /// Claims about runs, in source order.
    pub claims: Vec<ExpandedClaim>,
    /// Instances of patterns. The instance with index i has the number i + 1 in [`NameKey::scope`].
    pub grown: Vec<PatternInstance>,
    /// Number of visited statements.
    pub(crate) steps: usize,
    /// Branches of conditions that are taken or skipped.
    pub(crate) branches: Branches,
    /// First words of names whose block or instance may be missing because of a wrong statement.
    pub uncertain: FxHashSet<Symbol>,
}

impl ExpandedProgram {
    /// Returns the phase of an event. Returns `None` for an event outside of every phase.
    pub fn phase_of(&self, event: EventId) -> Option<usize> {
        let ended = |phase: &ExpandedPhase| phase.events.end <= event.0;
        let number = self.phases.partition_point(ended);
        let phase = self.phases.get(number)?;
        phase.events.contains(&event.0).then_some(number)
    }

    /// Returns whether a wrong statement may be the reason that the block is missing.
    pub(crate) fn is_uncertain(&self, role: RoleId) -> bool {
        self.uncertain.contains(&self.roles.key(role).word)
    }

    /// Returns the name of the phase of an event, or an empty text.
    pub fn phase_name(&self, event: EventId) -> &str {
        let phase = self.phase_of(event);
        phase.map_or("", |number| &self.phases[number].name)
    }
}

/// An instance of a pattern.
#[derive(Clone, Copy, Debug)]
pub struct PatternInstance {
    /// Name of the pattern.
    pub pattern: Symbol,
    /// Location of the pattern's declaration.
    pub declared: SourceLocation,
    /// Statement of the instance, without the name of the instance.
    pub call: SourceLocation,
    /// Whether an argument is wrong, so that blocks may be missing.
    pub is_uncertain: bool,
}

/// A named block of the plate.
#[derive(Clone, Copy, Debug)]
pub struct ExpandedSeed {
    /// Role of the seed.
    pub role: RoleId,
    /// Cell of the seed, with z = 0.
    pub cell: Cell,
    /// Location of the name.
    pub location: SourceLocation,
    /// Location of the whole statement. `None` if the statement has documentation: then no fix may
    /// remove the statement.
    pub statement: Option<SourceLocation>,
}

/// A phase with loops and patterns expanded.
#[derive(Clone, Debug)]
pub struct ExpandedPhase {
    /// Name of the phase.
    pub name: String,
    /// Location of the name.
    pub location: SourceLocation,
    /// Time limit of the phase. `None` without a limit.
    pub timeout: Option<Timeout>,
    /// Range of the phase's events in [`ExpandedProgram::events`].
    pub events: std::ops::Range<u32>,
    /// Whether the blocks of the phase are pre-attached. Only the first phase can have pre-attached
    /// blocks.
    pub pre_attached: bool,
    /// Claims about the structure at the end of the phase.
    pub claims: Vec<ShapeClaim>,
    /// Reaction to a timeout. `None` if a timeout ends the run.
    pub recovery: Option<PhaseRecovery>,
    /// Shortest durations of the phase. The longest one applies.
    pub waits: Vec<Timeout>,
}

/// Claim about the structure at the end of a phase.
#[derive(Clone, Copy, Debug)]
pub struct ShapeClaim {
    /// Name of the shape.
    pub shape: Symbol,
    /// Whether the structure may have further blocks.
    pub at_least: bool,
    /// Location of the name.
    pub location: SourceLocation,
}

/// Reaction to a timeout of a phase: all its captures are released, and the phase begins again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseRecovery {
    /// Largest number of repetitions. At least 1.
    pub retries: u32,
    /// Time between the last release and the next attempt. `None` without a pause.
    pub pause: Option<Timeout>,
}

/// A claim about runs. Its names are not resolved.
#[derive(Clone, Debug)]
pub struct ExpandedClaim {
    /// The claim.
    pub kind: ClaimKind,
    /// Location of the whole statement.
    pub location: SourceLocation,
}

/// Kind of an [`ExpandedClaim`].
#[derive(Clone, Debug)]
pub enum ClaimKind {
    /// Probability of an event.
    Probability {
        /// The event.
        event: ExpandedEventName,
        /// Time limit for the event.
        within: Option<Timeout>,
        /// Relation of the probability to the bound.
        relation: Relation,
        /// Bound between 0 and 1.
        bound: f64,
    },
    /// Mean completion time.
    Mean {
        /// Relation of the mean to the bound.
        relation: Relation,
        /// Bound of the mean.
        bound: Timeout,
    },
    /// Comparison with another program.
    Faster {
        /// Name of the other program, with its location.
        than: (Symbol, SourceLocation),
        /// Smallest relative difference, from 0 to 1.
        by: f64,
    },
}

/// Name of an event in a claim.
#[derive(Clone, Debug)]
pub enum ExpandedEventName {
    /// The program completes.
    Completion,
    /// A phase ends.
    Phase(String, SourceLocation),
    /// A block is captured by another block.
    Capture {
        /// Captured block.
        block: (NameKey, SourceLocation),
        /// Capturing block.
        by: (NameKey, SourceLocation),
    },
}

/// Time limit of a phase or a claim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Timeout {
    /// Number of ticks of the scene.
    Ticks(u64),
    /// Number of seconds.
    Seconds(f64),
}

impl Timeout {
    /// Largest timeout \[ticks\]. A double represents all smaller integers exactly.
    const MAX_TICKS: f64 = 9e15;

    /// Converts a quantity of time to a timeout. Returns `None` if the quantity is not positive.
    pub(crate) fn from_quantity(quantity: &Quantity) -> Option<Timeout> {
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

    pub(crate) fn is_in_ticks(quantity: &Quantity) -> bool {
        to_si(quantity).1 == Dimension::TICKS
    }

    /// Returns whether the unit of a quantity is a tick or a unit of time.
    pub(crate) fn is_a_time(quantity: &Quantity) -> bool {
        [Dimension::TICKS, Dimension::TIME].contains(&to_si(quantity).1)
    }

    /// Returns the time limit \[ticks\], from 1 to 9e15. `tick` is the length of a tick \[s\].
    pub fn ticks(self, tick: f64) -> u64 {
        let ticks = self.exact_ticks(tick);
        ticks.round().clamp(1.0, Timeout::MAX_TICKS) as u64
    }

    /// Returns the time limit \[ticks\]. It may be a fraction. `tick` is the length of a tick
    /// \[s\].
    pub(crate) fn exact_ticks(self, tick: f64) -> f64 {
        /// Largest relative difference due to the conversion of decimal numbers to binary ones.
        const ROUNDING: f64 = 1e-12;
        match self {
            Timeout::Ticks(ticks) => ticks as f64,
            Timeout::Seconds(seconds) => {
                let ticks = seconds / tick;
                let whole = ticks.round();
                if (ticks - whole).abs() <= ROUNDING * ticks {
                    whole
                } else {
                    ticks
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Timeout;

    #[test]
    fn only_rounding_errors_are_removed() {
        for (seconds, tick, ticks) in [
            (0.3, 0.1, 3.0),
            (0.35, 0.1, 3.5),
            (60.0, 0.02, 3000.0),
            (60.0 + 1e-6, 0.02, 3000.00005),
        ] {
            let exact = Timeout::Seconds(seconds).exact_ticks(tick);
            assert!((exact - ticks).abs() < 1e-9 * ticks, "{exact}");
            assert_eq!(exact.fract() == 0.0, f64::fract(ticks) == 0.0, "{exact}");
        }
    }
}

/// A capture or a release.
#[derive(Clone, Copy, Debug)]
pub struct ExpandedEvent {
    /// Kind of the event.
    pub kind: EventKind,
    /// Captured or released block.
    pub role: RoleId,
    /// Location in the source.
    pub location: SourceLocation,
    /// Whether the event is valid. Invalid events have been reported and are ignored.
    pub valid: bool,
}

/// Kind of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EventKind {
    /// A block switches on a face and names the block that docks there.
    Capture {
        /// Name of the capturing block.
        parent: RoleId,
        /// The face, in the frame of the structure.
        face: Face,
    },
    /// A block asks its parent to release it.
    Release,
}

/// An additional dependency by `after`.
#[derive(Clone, Copy, Debug)]
pub struct AfterConstraint {
    /// The waiting event.
    pub event: EventId,
    /// Block to wait for.
    pub role: RoleId,
    /// Whether the event waits for the release of the block instead of its capture.
    pub release: bool,
    /// Location in the source.
    pub location: SourceLocation,
}

/// Time between the events that a release waits for, and the release.
#[derive(Clone, Copy, Debug)]
pub struct ReleaseDelay {
    /// The release.
    pub event: EventId,
    /// The time.
    pub time: Timeout,
    /// Location in the source.
    pub location: SourceLocation,
}

/// A name as a key for maps: scope, word and indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct NameKey {
    /// Number of the pattern instance that contains the name, from 1. 0 for the program itself.
    pub scope: u32,
    /// Word of the name.
    pub word: Symbol,
    /// Number of indices.
    pub arity: u8,
    /// Values of the indices.
    pub index: [i32; NameKey::MAX_INDICES],
}

impl NameKey {
    pub(crate) const MAX_INDICES: usize = 3;

    /// Returns the same name in another scope.
    #[must_use]
    pub fn within(self, scope: u32) -> NameKey {
        NameKey { scope, ..self }
    }
}

/// Names of all blocks and of named instances of patterns.
#[derive(Clone, Debug, Default)]
pub struct Roles {
    roles: FxHashMap<NameKey, RoleId>,
    keys: Vec<NameKey>,
    scopes: FxHashMap<NameKey, u32>,
    scope_keys: Vec<NameKey>,
}

impl Roles {
    /// Returns the role of a name. Creates the role if needed.
    pub fn intern(&mut self, key: NameKey) -> RoleId {
        let next = RoleId(self.keys.len() as u32);
        let role = *self.roles.entry(key).or_insert(next);
        if role == next {
            self.keys.push(key);
        }
        role
    }

    /// Returns the role of a name. Returns `None` if the name has no role.
    pub fn get(&self, key: &NameKey) -> Option<RoleId> {
        self.roles.get(key).copied()
    }

    /// Returns the number of names.
    pub fn count(&self) -> usize {
        self.keys.len()
    }

    /// Returns the key of a role.
    pub fn key(&self, role: RoleId) -> NameKey {
        self.keys[role.0 as usize]
    }

    /// Returns the path of a role: the instances around it from the outermost, then its own name.
    pub fn path(&self, role: RoleId) -> Vec<NameKey> {
        let mut path = vec![self.key(role)];
        while let Some(&NameKey { scope: 1.., .. }) = path.last() {
            let scope = path[path.len() - 1].scope;
            path.push(self.scope_keys[scope as usize - 1]);
        }
        path.reverse();
        path
    }

    /// Returns the name of the pattern if a role is inside an unnamed instance. Returns `None` for
    /// a role that the program can name.
    pub fn nameless<'s>(&self, role: RoleId, symbols: &'s Symbols) -> Option<&'s str> {
        let path = self.path(role).into_iter();
        let mut patterns = path.filter_map(|key| symbols.word(key.word).split_once('#'));
        patterns.next().map(|(pattern, _)| pattern)
    }

    /// Returns the scope of an instance. Creates the scope if needed.
    pub(crate) fn intern_scope(&mut self, key: NameKey) -> u32 {
        let next = self.scope_keys.len() as u32 + 1;
        let scope = *self.scopes.entry(key).or_insert(next);
        if scope == next {
            self.scope_keys.push(key);
        }
        scope
    }

    /// Returns the scope of an instance. Returns `None` if the instance is unknown.
    pub fn scope(&self, key: &NameKey) -> Option<u32> {
        self.scopes.get(key).copied()
    }

    /// Returns the keys of the instances in a scope.
    pub fn instances(&self, scope: u32) -> impl Iterator<Item = NameKey> {
        let all = self.scope_keys.iter().copied();
        all.filter(move |key| key.scope == scope)
    }

    /// Returns the scope around an instance. Returns `None` for the program itself.
    pub fn outer(&self, scope: u32) -> Option<u32> {
        let key = self.scope_keys.get((scope as usize).checked_sub(1)?)?;
        Some(key.scope)
    }

    /// Returns a role's name as the program writes it, such as `a.T[2]`.
    pub fn name(&self, role: RoleId, symbols: &Symbols) -> String {
        self.name_of(self.key(role), symbols)
    }

    /// Returns the text of a name, such as `T[2]`.
    pub fn name_of(&self, key: NameKey, symbols: &Symbols) -> String {
        let mut text = String::new();
        self.write(key, symbols, &mut text);
        text
    }

    fn write(&self, key: NameKey, symbols: &Symbols, text: &mut String) {
        use std::fmt::Write as _;
        // The depth of the expansion bounds the depth of scopes.
        let scope = (key.scope as usize).checked_sub(1);
        // While events are only counted, scopes have no keys.
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

impl ExpandedEvent {
    /// Returns an event without its source location.
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

impl ExpandedProgram {
    /// Removes the expanded events and phases. The plate remains.
    pub(crate) fn clear(&mut self) {
        self.seeds = Vec::new();
        self.roles = Roles::default();
        self.phases = Vec::new();
        self.events = Vec::new();
        self.afters = Vec::new();
        self.delays = Vec::new();
    }

    /// Returns an event.
    pub fn event(&self, id: EventId) -> &ExpandedEvent {
        &self.events[id.0 as usize]
    }

    /// Returns the acting block: the capturing block, or the released block.
    pub(crate) fn actor(&self, id: EventId) -> RoleId {
        let event = self.event(id);
        match event.kind {
            EventKind::Capture { parent, .. } => parent,
            EventKind::Release => event.role,
        }
    }

    /// Returns the time that a release waits after its dependencies \[ticks\]. `tick` is the length
    /// of a tick \[s\].
    pub fn delay(&self, id: EventId, tick: f64) -> Option<u32> {
        let delays = &self.delays;
        let found = delays.binary_search_by_key(&id, |delay| delay.event).ok()?;
        u32::try_from(delays[found].time.ticks(tick)).ok()
    }

    /// Returns the events of a phase.
    pub fn events_of(&self, phase: &ExpandedPhase) -> impl Iterator<Item = EventId> + use<> {
        phase.events.clone().map(EventId)
    }

    /// Returns the numbers of captures and of releases.
    pub fn counts(&self) -> (usize, usize) {
        let releases = (self.events.iter())
            .filter(|event| event.kind == EventKind::Release)
            .count();
        (self.events.len() - releases, releases)
    }

    /// Returns the number of pre-attached blocks.
    pub fn pre_attached(&self) -> usize {
        let pre_attached = self.phases.iter().filter(|phase| phase.pre_attached);
        pre_attached.map(|phase| phase.events.len()).sum()
    }

    /// Returns an event as text: `A.up -> E` or `release E`.
    pub fn describe(&self, id: EventId, symbols: &Symbols) -> String {
        let action = self.event(id).action();
        action.describe(|role| self.roles.name(role, symbols))
    }
}
