//! Goals of a program, phase by phase.
use std::collections::{BTreeMap, BTreeSet};

use stochc_ir::Cell;
use stochc_ir::table::{Action, Condition, Notification, PhaseId, RoleId, Tables};

use crate::Reporter;

/// Goals of each phase of a program, and the structure at the end of each phase.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramGoals {
    pub(super) phases: Vec<PhaseGoal>,
}

/// Goals of one phase, and the structure at its end.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct PhaseGoal {
    pub captures: BTreeSet<RoleId>,
    pub releases: BTreeSet<RoleId>,
    /// Predecessors of each event.
    pub needs: BTreeMap<Notification, BTreeSet<Notification>>,
    /// Captures that need a given number of the listed predecessors.
    pub turns: BTreeMap<Notification, (usize, Vec<Notification>)>,
    /// Reports to the plate, each once.
    pub reports: BTreeSet<Reporter>,
    /// Cells filled in the phase.
    pub cells: BTreeSet<Cell>,
    /// Cell of each role at the end of the phase, including seeds.
    pub structure: BTreeMap<RoleId, Cell>,
}

/// Capture or release as declared by the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExpectedEvent {
    /// Phase of the event.
    pub phase: PhaseId,
    /// The expected event.
    pub event: Notification,
    /// Cell of the captured block, for captures.
    pub cell: Option<Cell>,
    /// Predecessors within the phase.
    pub waits_for: Vec<Notification>,
    /// Required number of earlier captures by the same parent, and the list of these captures.
    pub turn: (usize, Vec<Notification>),
}

impl ProgramGoals {
    /// Derives the goals from the tables and the conditions of their rules.
    pub fn new(tables: &Tables) -> ProgramGoals {
        let mut events = Vec::new();
        for duty in tables.duties() {
            for (index, rule) in duty.rules().enumerate() {
                let (event, cell) = match rule.then {
                    Action::Magnetize { child, cell, .. } => {
                        (Notification::Anchored(child), Some(cell))
                    }
                    Action::SwitchOff { child, .. } => (Notification::Released(child), None),
                    Action::AskRelease | Action::AskReleaseLater(_) => {
                        (Notification::Released(duty.role), None)
                    }
                    Action::Report | Action::Notify { .. } => continue,
                };
                let waits_for = rule
                    .when
                    .iter()
                    .filter_map(|condition| reported_event(*condition));
                let needed = rule.when.iter().find_map(|condition| match condition {
                    Condition::Turn(needed) => Some(usize::from(*needed)),
                    _ => None,
                });
                events.push(ExpectedEvent {
                    phase: duty.phase,
                    event,
                    cell,
                    waits_for: waits_for.collect(),
                    turn: (
                        needed.unwrap_or(0),
                        duty.given_before(index)
                            .map(Notification::Anchored)
                            .collect(),
                    ),
                });
            }
        }
        ProgramGoals::from_events(tables, events)
    }

    /// Returns the goals of events that were declared independently of the tables. Only the reports
    /// are taken from the tables.
    ///
    /// A phase may both capture and release a role. If the role is occupied at the start of the
    /// phase, the release comes first. Otherwise, the capture comes first.
    pub fn from_events(
        tables: &Tables,
        events: impl IntoIterator<Item = ExpectedEvent>,
    ) -> ProgramGoals {
        let mut phases = vec![PhaseGoal::default(); tables.phases.len()];
        let mut cells: BTreeMap<(PhaseId, RoleId), Cell> = BTreeMap::new();
        for expected in events {
            let stage = &mut phases[expected.phase.0 as usize];
            match expected.event {
                Notification::Anchored(child) => {
                    stage.captures.insert(child);
                    stage.cells.extend(expected.cell);
                    cells.extend(expected.cell.map(|cell| ((expected.phase, child), cell)));
                }
                Notification::Released(child) => {
                    stage.releases.insert(child);
                }
            }
            let needs = stage.needs.entry(expected.event).or_default();
            needs.extend(expected.waits_for);
            if expected.turn.0 > 0 {
                stage.turns.insert(expected.event, expected.turn);
            }
        }
        for duty in tables.duties() {
            let reports = duty.rules().enumerate();
            let reports = reports.filter(|(_, rule)| rule.then == Action::Report);
            let stage = &mut phases[duty.phase.0 as usize];
            stage.reports.extend(reports.map(|(index, _)| Reporter {
                role: duty.role,
                trigger: duty.trigger,
                rule: index as u32,
            }));
        }
        let mut structure: BTreeMap<RoleId, Cell> = tables.seeds().collect();
        for (number, stage) in phases.iter_mut().enumerate() {
            let phase = PhaseId(number as u32);
            let held: BTreeSet<RoleId> = structure.keys().copied().collect();
            structure.retain(|role, _| !stage.releases.contains(role));
            for &role in &stage.captures {
                if held.contains(&role) || !stage.releases.contains(&role) {
                    structure.extend(cells.get(&(phase, role)).map(|&cell| (role, cell)));
                }
            }
            stage.structure = structure.clone();
        }
        ProgramGoals { phases }
    }

    /// Returns the cell of each role at the end of a phase, including seeds.
    pub fn structure(&self, phase: PhaseId) -> &BTreeMap<RoleId, Cell> {
        &self.phases[phase.0 as usize].structure
    }

    /// Returns the largest number of captures and releases in one phase.
    pub fn widest(&self) -> usize {
        let events = |stage: &PhaseGoal| stage.captures.len() + stage.releases.len();
        self.phases.iter().map(events).max().unwrap_or(0)
    }
}

/// Returns the event of a condition. Returns `None` for a condition without an event.
fn reported_event(condition: Condition) -> Option<Notification> {
    match condition {
        Condition::Docked(role) => Some(Notification::Anchored(role)),
        Condition::Released(role) => Some(Notification::Released(role)),
        Condition::Notified(notification) => Some(notification),
        Condition::Asked(_) | Condition::Turn(_) => None,
    }
}
