//! What the machine looks up in its tables again and again.
use std::cmp::Ordering;
use std::sync::OnceLock;

use rustc_hash::FxHashMap;
use stochc_ir::Cell;
use stochc_ir::table::{Action, Duty, PhaseId, RoleId, RuleRange, Tables, Trigger};

use super::block_slot::BlockSlot;

/// Duties by role and by phase, blocks of the plate by cell.
#[derive(Debug)]
pub(super) struct Index {
    /// Of each role, its first duty.
    first_duty: Vec<FirstDuty>,
    /// The numbers of the duties that begin with a phase, by phase and in rising order.
    starting: Groups<u32>,
    /// The blocks of the plate, by cell.
    seeds: FxHashMap<Cell, BlockSlot>,
    /// Who captures whom. Made when it is asked for first.
    captors: OnceLock<Captors>,
}

/// Who captures each role, by role and phase: few roles are captured in more than one.
#[derive(Debug)]
struct Captors(Groups<(PhaseId, RoleId)>);

/// Values by the number of their group, sorted by counting.
#[derive(Debug)]
struct Groups<T> {
    /// Where the values of each group begin; and the end of the last.
    starts: Vec<u32>,
    values: Vec<T>,
}

impl<T: Copy> Groups<T> {
    /// Those of a group stay in their order. There are `groups` of them.
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

    /// Those of one group.
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

    /// Those of a role, by phase.
    fn of_role(&self, role: RoleId) -> &[(PhaseId, RoleId)] {
        self.0.get(role.0)
    }
}

/// The first duty of a role, which most often is the only one.
#[derive(Clone, Copy, Debug)]
struct FirstDuty {
    /// When it begins; `None`: the role has no duty.
    when: Option<(PhaseId, Trigger)>,
    /// Its number, and that of the first one of a later role.
    numbers: (u32, u32),
    begins: Beginning,
}

/// How a duty begins; of none nothing does.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Beginning {
    pub rules: RuleRange,
    /// What the first rule does, if it waits for nothing: so nobody has to look at it, which takes longest where tables are large.
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

    /// Where the block of the plate in a cell is kept.
    pub fn seed(&self, cell: Cell) -> Option<BlockSlot> {
        self.seeds.get(&cell).copied()
    }

    /// How the duty of a role in a phase from `trigger` on begins.
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

    /// The duties that begin with a phase.
    pub fn starting(&self, phase: PhaseId) -> &[u32] {
        self.starting.get(phase.0)
    }

    /// The first role that captures `child` in a phase.
    pub fn captor(&self, tables: &Tables, phase: PhaseId, child: RoleId) -> Option<RoleId> {
        let captors = self.captors.get_or_init(|| Captors::new(tables));
        let of_role = captors.of_role(child);
        let first = of_role.partition_point(|&(when, _)| when < phase);
        let &(when, captor) = of_role.get(first)?;
        (when == phase).then_some(captor)
    }
}

/// How the duty that begins then does, among those with these numbers.
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
