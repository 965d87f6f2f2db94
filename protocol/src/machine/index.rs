//! What the machine looks up in its tables again and again.
use std::cmp::Ordering;
use std::sync::OnceLock;

use rustc_hash::FxHashMap;
use stochc_ir::Cell;
use stochc_ir::table::{Action, Duty, PhaseId, RoleId, RuleRange, Tables, Trigger};

use super::slots::BlockSlot;

/// Duties by role and by phase, blocks of the plate by cell.
#[derive(Debug)]
pub(super) struct Index {
    /// Of each role, its first duty.
    first_duty: Vec<FirstDuty>,
    /// The duties that begin with a phase: phase and number, sorted.
    starting: Vec<(PhaseId, u32)>,
    /// The blocks of the plate, by cell.
    seeds: FxHashMap<Cell, BlockSlot>,
    /// Who captures whom: child, phase and captor, sorted. Made when it is asked for first.
    captors: OnceLock<Vec<(RoleId, PhaseId, RoleId)>>,
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
    fn of(tables: &Tables, duty: Duty<'_>) -> Beginning {
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
                    begins: Beginning::of(tables, duty),
                };
            }
            first.numbers.1 = number + 1;
            if duty.trigger == Trigger::Start {
                starting.push((duty.phase, number));
            }
        }
        starting.sort_unstable();
        let seeds = (0..).map(BlockSlot).zip(seeds);
        Index {
            first_duty,
            starting,
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
    pub fn starting(&self, phase: PhaseId) -> impl Iterator<Item = u32> {
        let first = self.starting.partition_point(|(its, _)| *its < phase);
        let of_phase = self.starting[first..]
            .iter()
            .take_while(move |(its, _)| *its == phase);
        of_phase.map(|(_, number)| *number)
    }

    /// The first role that captures `child` in a phase.
    pub fn captor(&self, tables: &Tables, phase: PhaseId, child: RoleId) -> Option<RoleId> {
        let captors = self.captors.get_or_init(|| captors(tables));
        let first = captors.partition_point(|&(given, when, _)| (given, when) < (child, phase));
        let &(given, when, captor) = captors.get(first)?;
        ((given, when) == (child, phase)).then_some(captor)
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
            Ordering::Equal => return Beginning::of(tables, duty),
            Ordering::Greater => high = middle,
        }
    }
    Beginning::default()
}

fn captors(tables: &Tables) -> Vec<(RoleId, PhaseId, RoleId)> {
    let mut captors = Vec::new();
    for duty in tables.duties() {
        let given = duty.rules().filter_map(|rule| match rule.then {
            Action::Magnetize { child, .. } => Some(child),
            _ => None,
        });
        captors.extend(given.map(|child| (child, duty.phase, duty.role)));
    }
    captors.sort_unstable();
    captors
}
