//! What a program is meant to do, phase by phase.
use std::collections::{BTreeMap, BTreeSet};

use stochc_ir::Cell;
use stochc_ir::table::{Action, Condition, News, PhaseId, RoleId, Tables};

use crate::Reporter;

/// What each phase of a program has to do, and what it leaves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramGoals {
    /// One entry per phase.
    pub(super) phases: Vec<PhaseGoal>,
}

/// What one phase has to do, and what it leaves.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct PhaseGoal {
    /// The roles that are given in it.
    pub captures: BTreeSet<RoleId>,
    /// The roles that end in it.
    pub releases: BTreeSet<RoleId>,
    /// What each event waits for.
    pub needs: BTreeMap<News, BTreeSet<News>>,
    /// Captures that wait until so many of these have happened.
    pub turns: BTreeMap<News, (usize, Vec<News>)>,
    /// The reports that come to the plate, each once.
    pub reports: BTreeSet<Reporter>,
    /// The cells that are filled in it.
    pub cells: BTreeSet<Cell>,
    /// Who sits where at its end, seeds included.
    pub structure: BTreeMap<RoleId, Cell>,
}

/// A capture or release as the program means it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Meant {
    /// When.
    pub phase: PhaseId,
    /// What happens.
    pub event: News,
    /// Of a capture, where its block sits.
    pub cell: Option<Cell>,
    /// The events of the phase that have to come before.
    pub waits_for: Vec<News>,
    /// So many of these have to come before.
    pub turn: (usize, Vec<News>),
}

impl ProgramGoals {
    /// Reads tables as a list of captures and releases that wait for whatever their conditions say.
    pub fn new(tables: &Tables) -> ProgramGoals {
        let mut events = Vec::new();
        for duty in tables.duties() {
            for (place, rule) in duty.rules().enumerate() {
                let (event, cell) = match rule.then {
                    Action::Magnetize { child, cell, .. } => (News::Anchored(child), Some(cell)),
                    Action::SwitchOff { child, .. } => (News::Released(child), None),
                    Action::AskRelease => (News::Released(duty.role), None),
                    Action::Report | Action::Tell { .. } => continue,
                };
                let waits_for = rule.when.iter().filter_map(|condition| news_of(*condition));
                let needed = rule.when.iter().find_map(|condition| match condition {
                    Condition::Turn(needed) => Some(usize::from(*needed)),
                    _ => None,
                });
                events.push(Meant {
                    phase: duty.phase,
                    event,
                    cell,
                    waits_for: waits_for.collect(),
                    turn: (
                        needed.unwrap_or(0),
                        duty.given_before(place).map(News::Anchored).collect(),
                    ),
                });
            }
        }
        ProgramGoals::meant(tables, events)
    }

    /// What somebody else says that tables are meant to do; only who reports is read off them.
    ///
    /// A name that is held when a phase begins is released before it is captured again; one that
    /// nobody holds is captured first.
    pub fn meant(tables: &Tables, events: impl IntoIterator<Item = Meant>) -> ProgramGoals {
        let mut phases = vec![PhaseGoal::default(); tables.phases.len()];
        let mut cells: BTreeMap<(PhaseId, RoleId), Cell> = BTreeMap::new();
        for meant in events {
            let stage = &mut phases[meant.phase.0 as usize];
            match meant.event {
                News::Anchored(child) => {
                    stage.captures.insert(child);
                    stage.cells.extend(meant.cell);
                    cells.extend(meant.cell.map(|cell| ((meant.phase, child), cell)));
                }
                News::Released(child) => {
                    stage.releases.insert(child);
                }
            }
            let needs = stage.needs.entry(meant.event).or_default();
            needs.extend(meant.waits_for);
            if meant.turn.0 > 0 {
                stage.turns.insert(meant.event, meant.turn);
            }
        }
        for duty in tables.duties() {
            let reports = duty.rules().enumerate();
            let reports = reports.filter(|(_, rule)| rule.then == Action::Report);
            let stage = &mut phases[duty.phase.0 as usize];
            stage.reports.extend(reports.map(|(place, _)| Reporter {
                role: duty.role,
                trigger: duty.trigger,
                rule: place as u32,
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

    /// Who sits where when a phase has ended, seeds included.
    pub fn structure(&self, phase: PhaseId) -> &BTreeMap<RoleId, Cell> {
        &self.phases[phase.0 as usize].structure
    }

    /// Captures and releases of the phase that has most of them.
    pub fn widest(&self) -> usize {
        let events = |stage: &PhaseGoal| stage.captures.len() + stage.releases.len();
        self.phases.iter().map(events).max().unwrap_or(0)
    }
}

/// The event that a condition stands for.
fn news_of(condition: Condition) -> Option<News> {
    match condition {
        Condition::Docked(role) => Some(News::Anchored(role)),
        Condition::Released(role) => Some(News::Released(role)),
        Condition::Heard(news) => Some(news),
        Condition::Asked(_) | Condition::Turn(_) => None,
    }
}
