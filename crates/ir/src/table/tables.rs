//! The event tables of one assembly.
use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::plate::Plate;
use super::rule::{Action, Condition, PhaseId, RoleId, Rule, Trigger};
use crate::Cell;
use crate::scene::BondKind;

/// Event tables of one assembly.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(try_from = "super::stored::StoredTables")]
pub struct Tables {
    /// Name of the assembly.
    pub assembly: String,
    /// Kind of bond, which determines how a face captures and releases.
    pub bond: BondKind,
    /// Number of faces that one block can magnetize at the same time.
    pub faces: u8,
    /// For an aggregate, the number of blocks in a complete group. Free blocks bond to each other
    /// without plate and rules. Phase i, counted from 0, ends when a group has i + 2 blocks. `None`
    /// for an assembly.
    pub aggregate: Option<u32>,
    /// Seed plate.
    pub plate: Plate,
    /// Phases in order.
    pub phases: Vec<Phase>,
    /// Roles. Seeds come first, in source order. Captured roles follow, in the order of their first
    /// capture.
    pub roles: Vec<Role>,
    /// Duties, sorted by (role, phase, trigger).
    duties: Vec<DutyRow>,
    /// Rules. Each duty owns a contiguous range.
    rules: Vec<RuleRow>,
    /// Conditions. Each rule owns a contiguous range.
    conditions: Vec<Condition>,
}

/// Name of the phase of pre-attached blocks. It is a keyword, so no other phase can have this name.
pub const PRE_ATTACHED: &str = "seed";

/// Phase of a program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Phase {
    /// Name in the program.
    pub name: String,
    /// Timeout \[ticks\]. `None` if the phase waits forever.
    pub timeout: Option<u64>,
    /// Number of reports after which the plate begins the next phase, in the next tick.
    pub reports: u32,
    /// Shortest duration of the phase, and of each attempt at it \[ticks\].
    #[serde(default, skip_serializing_if = "is_zero")]
    pub wait: u64,
    /// Reaction to a timeout. `None` if a timeout ends the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recovery: Option<Recovery>,
    /// Whether the blocks of the phase are pre-attached before the first tick. Such a phase comes
    /// first, takes no time, and consists of captures without reports.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub pre_attached: bool,
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde passes a reference"
)]
fn is_zero(ticks: &u64) -> bool {
    *ticks == 0
}

/// Reaction to a timeout: the plate aborts the phase, all its captures are released, and the phase
/// begins again. The phase has no releases of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Recovery {
    /// Largest number of repetitions. At least 1.
    pub retries: u32,
    /// Number of reports after which all captures are released: one from each block that stood at
    /// the start of the phase and captures in it.
    pub reports: u32,
    /// Time from the last of these reports to the next attempt \[ticks\].
    pub pause: u64,
}

/// A role: a name in the program that blocks take.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Role {
    /// Name as in the program, such as `E`, `T[2]` or `a.T[2]`.
    pub name: String,
    /// Cell of a seed. `None` for a captured role.
    pub seed: Option<Cell>,
}

/// Rules of a role in one phase, for one trigger.
#[derive(Clone, Copy, Debug)]
pub struct Duty<'a> {
    /// Role that has the duty.
    pub role: RoleId,
    /// Phase of the duty.
    pub phase: PhaseId,
    /// Event that starts the duty.
    pub trigger: Trigger,
    pub(super) tables: &'a Tables,
    rules: RuleRange,
}

/// Contiguous range of rules of a duty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RuleRange {
    pub(super) first: u32,
    pub(super) end: u32,
}

impl RuleRange {
    /// Returns the number of rules.
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
    /// Index of the first rule. The rules end at the first rule of the next duty.
    pub rules: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct RuleRow {
    /// Index of the first condition. The conditions end at the first condition of the next rule.
    pub when: u32,
    pub then: Action,
}

impl<'a> Duty<'a> {
    /// Returns the rules in the order of evaluation.
    #[inline]
    pub fn rules(&self) -> impl ExactSizeIterator<Item = Rule<'a>> + use<'a> {
        let Duty { tables, rules, .. } = *self;
        (0..rules.count() as usize).map(move |index| tables.rule(rules, index))
    }

    /// Returns the range of the duty's rules.
    #[inline]
    pub fn range(&self) -> RuleRange {
        self.rules
    }

    /// Returns the roles that earlier rules of the duty assign. `index` is the index of a rule.
    pub fn given_before(&self, index: usize) -> impl Iterator<Item = RoleId> + use<'a> {
        self.tables.given_before(self.rules, index)
    }

    /// Returns whether a condition of the rule at `index` holds for a block with the observations
    /// `has`.
    pub fn is_true(&self, index: usize, when: Condition, has: impl Fn(Condition) -> bool) -> bool {
        self.tables.is_true(self.rules, index, when, has)
    }
}

/// Duty that is not stored in [`Tables`]: role, phase, trigger and rules.
pub type LooseDuty = (RoleId, PhaseId, Trigger, Vec<(Vec<Condition>, Action)>);

impl Tables {
    /// Returns tables without duties and with the default bond.
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

    /// Assembles tables from loose duties, for tools and tests.
    ///
    /// `duties` may be in any order. Duties without rules are dropped. The bond is the default one
    /// and can be changed through [`Tables::bond`].
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

    /// Reserves memory for additional rules and conditions.
    pub fn reserve(&mut self, rules: usize, conditions: usize) {
        self.rules.reserve_exact(rules);
        self.conditions.reserve_exact(conditions);
    }

    /// Begins a duty. Duties must be in the order of (role, phase, trigger).
    pub fn begin_duty(&mut self, role: RoleId, phase: PhaseId, trigger: Trigger) {
        let rules = self.rules.len() as u32;
        self.duties.push(DutyRow {
            role,
            phase,
            trigger,
            rules,
        });
    }

    /// Adds a rule to the current duty.
    pub fn push_rule(&mut self, when: impl IntoIterator<Item = Condition>, then: Action) {
        let start = self.conditions.len() as u32;
        self.conditions.extend(when);
        self.rules.push(RuleRow { when: start, then });
    }

    /// Returns the name of a role.
    pub fn name(&self, role: RoleId) -> &str {
        &self.roles[role.0 as usize].name
    }

    /// Returns the number of captures in all phases.
    pub fn captures(&self) -> usize {
        self.captured_cells().count()
    }

    /// Returns the number of blocks that stand at the start of each phase and capture in it.
    pub fn captors_at_start(&self) -> Vec<u32> {
        let mut captors = vec![0; self.phases.len()];
        for duty in self.duties() {
            let captures = |rule: Rule<'_>| matches!(rule.then, Action::Magnetize { .. });
            if duty.trigger == Trigger::Start && duty.rules().any(captures) {
                captors[duty.phase.0 as usize] += 1;
            }
        }
        captors
    }

    /// Returns the number of releases in all phases.
    pub fn releases(&self) -> usize {
        let is_release = |rule: &&RuleRow| matches!(rule.then, Action::SwitchOff { .. });
        self.rules.iter().filter(is_release).count()
    }

    /// Returns the cell of each capture, in the order of the rules.
    pub fn captured_cells(&self) -> impl Iterator<Item = Cell> {
        self.rules.iter().filter_map(|rule| match rule.then {
            Action::Magnetize { cell, .. } => Some(cell),
            _ => None,
        })
    }

    /// Returns the seeds with their cells.
    pub fn seeds(&self) -> impl Iterator<Item = (RoleId, Cell)> {
        self.roles
            .iter()
            .enumerate()
            .filter_map(|(i, role)| Some((RoleId(i as u32), role.seed?)))
    }

    /// Returns the duty of a role in a phase for a trigger. Returns `None` if the role has no such
    /// duty.
    pub fn duty(&self, role: RoleId, phase: PhaseId, trigger: Trigger) -> Option<Duty<'_>> {
        let key = (role, phase, trigger);
        let i = self
            .duties
            .binary_search_by_key(&key, |row| (row.role, row.phase, row.trigger))
            .ok()?;
        Some(self.duty_at(i))
    }

    /// Returns every duty, sorted by (role, phase, trigger).
    pub fn duties(&self) -> impl ExactSizeIterator<Item = Duty<'_>> {
        (0..self.duties.len()).map(|i| self.duty_at(i))
    }

    /// Returns the lowest and the highest layer of captures, or `None` without captures.
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

    /// Returns the duties of one role, sorted by (phase, trigger).
    pub(crate) fn duties_of(&self, role: RoleId) -> impl ExactSizeIterator<Item = Duty<'_>> {
        let start = self.duties.partition_point(|row| row.role < role);
        let end = self.duties.partition_point(|row| row.role <= role);
        (start..end).map(|i| self.duty_at(i))
    }

    /// Returns one of [`Tables::duties`] by its index.
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

    /// Returns a rule by its index in a range.
    #[inline]
    pub fn rule(&self, rules: RuleRange, index: usize) -> Rule<'_> {
        let number = rules.first as usize + index;
        let end = self.rules.get(number + 1);
        let end = end.map_or(self.conditions.len(), |next| next.when as usize);
        let RuleRow { when, then } = self.rules[number];
        Rule {
            when: &self.conditions[when as usize..end],
            then,
        }
    }

    fn given_before(&self, rules: RuleRange, index: usize) -> impl Iterator<Item = RoleId> {
        (0..index).filter_map(move |index| match self.rule(rules, index).then {
            Action::Magnetize { child, .. } => Some(child),
            _ => None,
        })
    }

    /// Returns whether a condition of a rule holds for a block with the observations `has`.
    #[inline]
    pub fn is_true(
        &self,
        rules: RuleRange,
        index: usize,
        when: Condition,
        has: impl Fn(Condition) -> bool,
    ) -> bool {
        match when {
            Condition::Turn(needed) => {
                let given = self.given_before(rules, index);
                given.filter(|&role| has(Condition::Docked(role))).count() >= usize::from(needed)
            }
            seen => has(seen),
        }
    }
}
