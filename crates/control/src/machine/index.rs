//! Lookup tables for the event tables.
use std::cmp::Ordering;
use std::sync::OnceLock;

use rustc_hash::FxHashMap;
use stochc_ir::Cell;
use stochc_ir::table::{Action, Duty, PhaseId, RoleId, RuleRange, Tables, Trigger};

use super::block_slot::BlockSlot;

/// Index of duties by role and by phase, and of the plate's blocks by cell.
#[derive(Debug)]
pub(super) struct Index {
    first_duty: Vec<FirstDuty>,
    /// Duties that begin with a phase, by phase and in rising order.
    starting: Groups<u32>,
    seeds: FxHashMap<Cell, BlockSlot>,
    /// Captors of each role. Computed on first use.
    captors: OnceLock<Captors>,
}

/// For each role, the phases that capture it and the capturing roles. Few roles are captured in
/// more than one phase.
#[derive(Debug)]
struct Captors(Groups<(PhaseId, RoleId)>);

/// Values by group, sorted by counting.
#[derive(Debug)]
struct Groups<T> {
    /// Start of each group, and end of the last.
    starts: Vec<u32>,
    values: Vec<T>,
}

impl<T: Copy> Groups<T> {
    /// Groups values into `groups` groups and keeps their order within each.
    fn new(groups: usize, values: &[(u32, T)]) -> Groups<T> {
        let mut starts = vec![0; groups + 1];
        for (group, _) in values {
            starts[*group as usize + 1] += 1;
        }
        for group in 0..groups {
            starts[group + 1] += starts[group];
        }
        let mut sorted: Vec<T> = values.iter().map(|(_, value)| *value).collect();
        let mut next = starts.clone();
        for (group, value) in values {
            let at = &mut next[*group as usize];
            sorted[*at as usize] = *value;
            *at += 1;
        }
        Groups {
            starts,
            values: sorted,
        }
    }

    fn get(&self, group: u32) -> &[T] {
        let [start, end] = [0, 1].map(|next| self.starts[group as usize + next] as usize);
        &self.values[start..end]
    }
}

impl Captors {
    fn new(tables: &Tables) -> Captors {
        let mut captures = Vec::new();
        for duty in tables.duties() {
            let given = duty.rules().filter_map(|rule| match rule.then {
                Action::Magnetize { child, .. } => Some(child),
                _ => None,
            });
            captures.extend(given.map(|child| (child.0, (duty.phase, duty.role))));
        }
        captures.sort_unstable_by_key(|&(_, captor)| captor);
        Captors(Groups::new(tables.roles.len(), &captures))
    }

    /// Returns the captors of a role, by phase.
    fn of_role(&self, role: RoleId) -> &[(PhaseId, RoleId)] {
        self.0.get(role.0)
    }
}

/// First duty of a role, usually its only one.
#[derive(Clone, Copy, Debug)]
struct FirstDuty {
    /// Phase and trigger. `None` if the role has no duty.
    when: Option<(PhaseId, Trigger)>,
    /// Number of this duty, and the first number of the next role's duties.
    numbers: (u32, u32),
    begins: Beginning,
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Beginning {
    pub rules: RuleRange,
    /// Action of the first rule, if it has no condition. Saves a lookup in large tables.
    pub at_once: Option<Action>,
}

impl Beginning {
    fn new(tables: &Tables, duty: Duty<'_>) -> Beginning {
        let rules = duty.range();
        let first = (rules.count() > 0).then(|| tables.rule(rules, 0));
        let at_once = first.filter(|first| first.when.is_empty());
        Beginning {
            rules,
            at_once: at_once.map(|first| first.then),
        }
    }
}

impl Index {
    pub fn new(tables: &Tables, seeds: &[Cell]) -> Index {
        let none = FirstDuty {
            when: None,
            numbers: (0, 0),
            begins: Beginning::default(),
        };
        let mut first_duty = vec![none; tables.roles.len()];
        let mut starting = Vec::new();
        for (number, duty) in (0..).zip(tables.duties()) {
            let first = &mut first_duty[duty.role.0 as usize];
            if first.when.is_none() {
                *first = FirstDuty {
                    when: Some((duty.phase, duty.trigger)),
                    numbers: (number, number),
                    begins: Beginning::new(tables, duty),
                };
            }
            first.numbers.1 = number + 1;
            if duty.trigger == Trigger::Start {
                starting.push((duty.phase.0, number));
            }
        }
        let seeds = (0..).map(BlockSlot).zip(seeds);
        Index {
            first_duty,
            starting: Groups::new(tables.phases.len(), &starting),
            seeds: seeds.map(|(slot, cell)| (*cell, slot)).collect(),
            captors: OnceLock::new(),
        }
    }

    /// Returns the index of the plate's block in a cell. Returns `None` for a cell outside of the
    /// plate.
    pub fn seed(&self, cell: Cell) -> Option<BlockSlot> {
        self.seeds.get(&cell).copied()
    }

    #[inline]
    pub fn beginning(
        &self,
        tables: &Tables,
        role: RoleId,
        phase: PhaseId,
        trigger: Trigger,
    ) -> Beginning {
        let first = &self.first_duty[role.0 as usize];
        match first.when.map(|when| when.cmp(&(phase, trigger))) {
            Some(Ordering::Equal) => first.begins,
            Some(Ordering::Less) => later_beginning(tables, first.numbers, (phase, trigger)),
            _ => Beginning::default(),
        }
    }

    /// Returns the duties that begin with a phase.
    pub fn starting(&self, phase: PhaseId) -> &[u32] {
        self.starting.get(phase.0)
    }

    /// Returns the first role that captures `child` in a phase. Returns `None` if no role captures
    /// it.
    pub fn captor(&self, tables: &Tables, phase: PhaseId, child: RoleId) -> Option<RoleId> {
        let captors = self.captors.get_or_init(|| Captors::new(tables));
        let of_role = captors.of_role(child);
        let first = of_role.partition_point(|&(when, _)| when < phase);
        let &(when, captor) = of_role.get(first)?;
        (when == phase).then_some(captor)
    }
}

/// Searches a range of duty numbers for the duty with this phase and trigger. Returns its start, or
/// an empty start if there is no such duty.
fn later_beginning(
    tables: &Tables,
    (mut low, mut high): (u32, u32),
    when: (PhaseId, Trigger),
) -> Beginning {
    while low < high {
        let middle = low.midpoint(high);
        let duty = tables.duty_at(middle as usize);
        match (duty.phase, duty.trigger).cmp(&when) {
            Ordering::Less => low = middle + 1,
            Ordering::Equal => return Beginning::new(tables, duty),
            Ordering::Greater => high = middle,
        }
    }
    Beginning::default()
}
