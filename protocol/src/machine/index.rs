//! What the machine looks up in its tables again and again.
use std::sync::OnceLock;

use rustc_hash::FxHashMap;
use stochc_ir::Cell;
use stochc_ir::table::{Action, Duty, PhaseId, RoleId, Tables, Trigger};

use super::slots::BlockSlot;

/// Duties by role and by phase, blocks of the plate by cell.
#[derive(Debug)]
pub(super) struct Index {
    /// The number of the first duty of each role, and of the one after the last.
    first_duty: Vec<u32>,
    /// The duties that begin with a phase: phase and number, sorted.
    starting: Vec<(PhaseId, u32)>,
    /// The blocks of the plate, by cell.
    seeds: FxHashMap<Cell, BlockSlot>,
    /// Who captures whom: child, phase and captor, sorted. Made when it is asked for first.
    captors: OnceLock<Vec<(RoleId, PhaseId, RoleId)>>,
}

impl Index {
    pub fn new(tables: &Tables, seeds: &[Cell]) -> Index {
        let mut first_duty = vec![0; tables.roles.len() + 1];
        let mut starting = Vec::new();
        for (number, duty) in tables.duties().enumerate() {
            first_duty[duty.role.0 as usize + 1] = number as u32 + 1;
            if duty.trigger == Trigger::Start {
                starting.push((duty.phase, number as u32));
            }
        }
        let mut last = 0;
        for first in &mut first_duty {
            last = last.max(*first);
            *first = last;
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

    /// The number of the duty of a role in a phase from `trigger` on.
    pub fn duty(
        &self,
        tables: &Tables,
        role: RoleId,
        phase: PhaseId,
        trigger: Trigger,
    ) -> Option<u32> {
        let (mut low, mut high) = (
            self.first_duty[role.0 as usize],
            self.first_duty[role.0 as usize + 1],
        );
        while low < high {
            let middle = low.midpoint(high);
            let Duty {
                phase: its,
                trigger: when,
                ..
            } = tables.duty_at(middle as usize);
            match (its, when).cmp(&(phase, trigger)) {
                std::cmp::Ordering::Less => low = middle + 1,
                std::cmp::Ordering::Equal => return Some(middle),
                std::cmp::Ordering::Greater => high = middle,
            }
        }
        None
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
