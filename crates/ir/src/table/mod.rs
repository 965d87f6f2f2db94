//! What every block knows: the lowered program.
//!
//! A [`Tables`] is the only thing that crosses from the compiler to the runtime. A *role* is a
//! name of the program; a block takes a role when it is captured and drops it when it is released,
//! and another block may take it later. For each phase a role holds up to two [`Duty`]s: one for a
//! block that already is anchored when the phase starts, one for a block that is captured during
//! it. A duty is a list of [`Rule`]s. A rule fires once, as soon as the duty has begun and all its
//! conditions have come true, and only speaks of what its block can see: its own faces, and
//! messages. The runtime needs nothing else, and holds no script.
mod hardware;
mod in_scene;
mod stored;

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::scene::BondKind;
use crate::{Cell, Face};

pub use crate::plate::Plate;

/// A name that blocks take in turn; an index into [`Tables::roles`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct RoleId(pub u32);

/// A phase of the program; an index into [`Tables::phases`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct PhaseId(pub u32);

/// The event tables of one assembly.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "stored::StoredTables")]
pub struct Tables {
    /// The name of the assembly.
    pub assembly: String,
    /// How the hardware bonds: what to capture and to release mean for a face.
    pub bond: BondKind,
    /// Faces that one block magnetizes at the same time, at most.
    pub faces: u8,
    /// Of an aggregate, the blocks of a group with which it is complete: free blocks bond to each other,
    /// there is no plate and nobody acts, and phase i ends as soon as some group has i + 2 blocks.
    pub aggregate: Option<u32>,
    /// What the seed plate knows.
    pub plate: Plate,
    /// The phases, in the order in which they run.
    pub phases: Vec<Phase>,
    /// Every role: first the seeds in source order, then the captured ones by first capture.
    pub roles: Vec<Role>,
    /// All duties, sorted by (role, phase, trigger).
    duties: Vec<DutyRow>,
    /// All rules; a duty owns a contiguous range.
    rules: Vec<RuleRow>,
    /// All conditions; a rule owns a contiguous range.
    conditions: Vec<Condition>,
}

/// The name of the phase of blocks that are attached by hand: a word of the language, so that
/// no other phase has it.
pub const PLANTED: &str = "seed";

/// One building stage.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Phase {
    /// Its name in the program.
    pub name: String,
    /// Ticks after which the phase has failed; `None`: it waits for ever.
    pub timeout: Option<u64>,
    /// Reports after which the plate starts the next phase, in the very next tick.
    pub reports: u32,
    /// Whether its blocks are attached by hand before the first tick, rather than captured. Such a
    /// phase comes first, takes no time, and has only captures, of which nobody reports.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub planted: bool,
}

/// A name of the program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Role {
    /// As the program writes it, such as `E`, `T[2]` or `a.T[2]`.
    pub name: String,
    /// The cell of a seed; `None` for a role that is captured.
    pub seed: Option<Cell>,
}

/// When a duty begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Trigger {
    /// At the start of the phase, for a block that is anchored then.
    Start,
    /// At its own anchoring, for a block that is captured during the phase.
    Anchored,
}

/// What a rule waits for, besides the beginning of its duty. Each is seen by the block itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Condition {
    /// A block has docked on this block's magnetized face and been given the role.
    Docked(RoleId),
    /// The child with this role asks to be let go.
    Asked(RoleId),
    /// This block has switched off the face that held the child with this role.
    Released(RoleId),
    /// A message has said so.
    Heard(News),
    /// Of the blocks that earlier rules of this duty capture, at least so many have docked: the block has a
    /// face to spare.
    Turn(u8),
}

/// An event that a message tells of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum News {
    /// A block has been anchored in this role during this phase.
    Anchored(RoleId),
    /// The block in this role has been released during this phase.
    Released(RoleId),
}

/// What a rule does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Action {
    /// Make a face capture, and give the role to the block that docks there.
    ///
    /// What that is depends on the [bond](Tables::bond): the face's magnet is switched on, or its
    /// valve is opened; a face that always attracts is expected to, and from then on what docks
    /// there is kept.
    Magnetize {
        /// In the structure's frame: the block turns it into its own by its orientation.
        face: Face,
        /// The role to give.
        child: RoleId,
        /// The lattice site across the face, where the child will sit.
        cell: Cell,
    },
    /// Ask the parent to let this block go.
    AskRelease,
    /// Let the child go that a face holds: switch the magnet off, close the valve, or reject it with
    /// an impulse.
    SwitchOff {
        /// In the structure's frame.
        face: Face,
        /// The role that ends.
        child: RoleId,
    },
    /// Send news to another block of the structure, along parents and children.
    Tell {
        /// The receiver.
        to: RoleId,
        /// What happened.
        news: News,
    },
    /// Report to the plate, along the chain of parents, that this branch of the phase is done.
    Report,
}

/// A rule as its block holds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Rule<'a> {
    /// All of these have to come true; none: at once.
    pub when: &'a [Condition],
    /// Done once, when they have.
    pub then: Action,
}

/// What a block in one role does in one phase.
#[derive(Clone, Copy, Debug)]
pub struct Duty<'a> {
    /// Whose.
    pub role: RoleId,
    /// In which phase.
    pub phase: PhaseId,
    /// From when on.
    pub trigger: Trigger,
    tables: &'a Tables,
    rules: RuleRange,
}

/// Some rules of tables, one after the other: those of a duty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RuleRange {
    first: u32,
    end: u32,
}

impl RuleRange {
    /// How many rules there are.
    #[inline]
    pub fn count(self) -> u32 {
        self.end - self.first
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct DutyRow {
    pub role: RoleId,
    pub phase: PhaseId,
    pub trigger: Trigger,
    /// Where its rules begin; they end where the next duty's begin.
    pub rules: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct RuleRow {
    /// Where its conditions begin; they end where the next rule's begin.
    pub when: u32,
    pub then: Action,
}

impl<'a> Duty<'a> {
    /// The rules, in the order in which the block tries them.
    #[inline]
    pub fn rules(&self) -> impl ExactSizeIterator<Item = Rule<'a>> + use<'a> {
        let Duty { tables, rules, .. } = *self;
        (0..rules.count() as usize).map(move |place| tables.rule(rules, place))
    }

    /// Which of all rules they are.
    #[inline]
    pub fn range(&self) -> RuleRange {
        self.rules
    }

    /// The roles that the rules before one give, by its place.
    pub fn given_before(&self, place: usize) -> impl Iterator<Item = RoleId> + use<'a> {
        self.tables.given_before(self.rules, place)
    }

    /// [`Tables::is_true`] of one of its rules.
    pub fn is_true(&self, place: usize, when: Condition, has: impl Fn(Condition) -> bool) -> bool {
        self.tables.is_true(self.rules, place, when, has)
    }
}

/// A duty that belongs to no tables yet: whose, when, and its rules.
pub type LooseDuty = (RoleId, PhaseId, Trigger, Vec<(Vec<Condition>, Action)>);

impl Tables {
    /// Tables in which nobody does anything yet, of the default bond.
    pub fn new(
        assembly: impl Into<String>,
        faces: u8,
        plate: Plate,
        phases: Vec<Phase>,
        roles: Vec<Role>,
    ) -> Tables {
        Tables {
            assembly: assembly.into(),
            bond: BondKind::default(),
            faces,
            aggregate: None,
            plate,
            phases,
            roles,
            duties: Vec::new(),
            rules: Vec::new(),
            conditions: Vec::new(),
        }
    }

    /// Puts tables together from loose duties, for tools and tests that write them by hand.
    ///
    /// `duties` may come in any order; an empty list of rules is left out. The bond is the default
    /// one; [`Tables::bond`] may be set afterwards.
    pub fn assemble(
        assembly: impl Into<String>,
        faces: u8,
        plate: Plate,
        phases: Vec<Phase>,
        roles: Vec<Role>,
        mut duties: Vec<LooseDuty>,
    ) -> Tables {
        duties.sort_by_key(|&(role, phase, trigger, _)| (role, phase, trigger));
        let mut tables = Tables::new(assembly, faces, plate, phases, roles);
        for (role, phase, trigger, rules) in duties {
            if !rules.is_empty() {
                tables.begin_duty(role, phase, trigger);
            }
            for (when, then) in rules {
                tables.push_rule(when, then);
            }
        }
        tables
    }

    /// Takes the memory for so many more rules and conditions at once.
    pub fn reserve(&mut self, rules: usize, conditions: usize) {
        self.rules.reserve_exact(rules);
        self.conditions.reserve_exact(conditions);
    }

    /// Opens a duty; duties have to come in the order of (role, phase, trigger).
    pub fn begin_duty(&mut self, role: RoleId, phase: PhaseId, trigger: Trigger) {
        let rules = self.rules.len() as u32;
        self.duties.push(DutyRow {
            role,
            phase,
            trigger,
            rules,
        });
    }

    /// Adds a rule to the duty opened last.
    pub fn push_rule(&mut self, when: impl IntoIterator<Item = Condition>, then: Action) {
        let start = self.conditions.len() as u32;
        self.conditions.extend(when);
        self.rules.push(RuleRow { when: start, then });
    }

    /// The name of a role.
    pub fn name(&self, role: RoleId) -> &str {
        &self.roles[role.0 as usize].name
    }

    /// How many captures there are in all phases.
    pub fn captures(&self) -> usize {
        self.captured_cells().count()
    }

    /// How many releases there are in all phases.
    pub fn releases(&self) -> usize {
        let is_release = |rule: &&RuleRow| matches!(rule.then, Action::SwitchOff { .. });
        self.rules.iter().filter(is_release).count()
    }

    /// The cell of each capture, in the order of the rules.
    pub fn captured_cells(&self) -> impl Iterator<Item = Cell> {
        self.rules.iter().filter_map(|rule| match rule.then {
            Action::Magnetize { cell, .. } => Some(cell),
            _ => None,
        })
    }

    /// The roles that are on the plate from the beginning, with their cells.
    pub fn seeds(&self) -> impl Iterator<Item = (RoleId, Cell)> {
        self.roles
            .iter()
            .enumerate()
            .filter_map(|(i, role)| Some((RoleId(i as u32), role.seed?)))
    }

    /// What a block in `role` does in `phase` from `trigger` on; `None`: nothing.
    pub fn duty(&self, role: RoleId, phase: PhaseId, trigger: Trigger) -> Option<Duty<'_>> {
        let key = (role, phase, trigger);
        let i = self
            .duties
            .binary_search_by_key(&key, |row| (row.role, row.phase, row.trigger))
            .ok()?;
        Some(self.duty_at(i))
    }

    /// Every duty, sorted by (role, phase, trigger).
    pub fn duties(&self) -> impl ExactSizeIterator<Item = Duty<'_>> {
        (0..self.duties.len()).map(|i| self.duty_at(i))
    }

    /// Returns the lowest and the highest layer of captures. `None` without captures.
    pub fn capture_layers(&self) -> Option<RangeInclusive<i32>> {
        let rules = self.duties().flat_map(|duty| duty.rules());
        let heights = rules.filter_map(|rule| match rule.then {
            Action::Magnetize { cell, .. } => Some(cell.z),
            _ => None,
        });
        heights.fold(None, |layers: Option<RangeInclusive<i32>>, z| {
            let (low, high) = layers.map_or((z, z), RangeInclusive::into_inner);
            Some(low.min(z)..=high.max(z))
        })
    }

    /// The duties of one role, sorted by (phase, trigger).
    pub(crate) fn duties_of(&self, role: RoleId) -> impl ExactSizeIterator<Item = Duty<'_>> {
        let start = self.duties.partition_point(|row| row.role < role);
        let end = self.duties.partition_point(|row| row.role <= role);
        (start..end).map(|i| self.duty_at(i))
    }

    /// One of [`Tables::duties`], by its number.
    #[inline]
    pub fn duty_at(&self, i: usize) -> Duty<'_> {
        let row = self.duties[i];
        let end = self
            .duties
            .get(i + 1)
            .map_or(self.rules.len() as u32, |next| next.rules);
        Duty {
            role: row.role,
            phase: row.phase,
            trigger: row.trigger,
            tables: self,
            rules: RuleRange {
                first: row.rules,
                end,
            },
        }
    }

    /// One of some rules, by its place among them.
    #[inline]
    pub fn rule(&self, rules: RuleRange, place: usize) -> Rule<'_> {
        let number = rules.first as usize + place;
        let end = self.rules.get(number + 1);
        let end = end.map_or(self.conditions.len(), |next| next.when as usize);
        let RuleRow { when, then } = self.rules[number];
        Rule {
            when: &self.conditions[when as usize..end],
            then,
        }
    }

    fn given_before(&self, rules: RuleRange, place: usize) -> impl Iterator<Item = RoleId> {
        (0..place).filter_map(move |place| match self.rule(rules, place).then {
            Action::Magnetize { child, .. } => Some(child),
            _ => None,
        })
    }

    /// Whether a condition of the rule at a place is true for a block that has seen what `has` says.
    #[inline]
    pub fn is_true(
        &self,
        rules: RuleRange,
        place: usize,
        when: Condition,
        has: impl Fn(Condition) -> bool,
    ) -> bool {
        match when {
            Condition::Turn(needed) => {
                let given = self.given_before(rules, place);
                given.filter(|&role| has(Condition::Docked(role))).count() >= usize::from(needed)
            }
            seen => has(seen),
        }
    }
}
