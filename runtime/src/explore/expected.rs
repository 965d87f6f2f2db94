//! What a program is meant to do, phase by phase.
use std::collections::{BTreeMap, BTreeSet};

use stochc_compiler::Cell;
use stochc_compiler::table::{Action, Condition, News, PhaseId, RoleId, Tables};

use crate::control::message::Reporter;

/// What each phase of a program has to do, and what it leaves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Expected {
    /// One entry per phase.
    pub(super) phases: Vec<Stage>,
}

/// What one phase has to do, and what it leaves.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Stage {
    /// The roles that are given in it.
    pub captures: BTreeSet<RoleId>,
    /// The roles that end in it.
    pub releases: BTreeSet<RoleId>,
    /// What each event waits for.
    pub needs: BTreeMap<News, BTreeSet<News>>,
    /// The reports that come to the plate, each once.
    pub reports: BTreeSet<Reporter>,
    /// The cells that are filled in it.
    pub cells: BTreeSet<Cell>,
    /// Who sits where at its end, seeds included.
    pub structure: BTreeMap<RoleId, Cell>,
}

impl Expected {
    /// Reads tables as a list of captures and releases, whatever their conditions.
    ///
    /// A name that is held when a phase begins is released before it is captured again; one that
    /// nobody holds is captured first.
    pub fn of(tables: &Tables) -> Expected {
        let mut phases = vec![Stage::default(); tables.phases.len()];
        let mut cells: BTreeMap<(PhaseId, RoleId), Cell> = BTreeMap::new();
        for duty in tables.duties() {
            let stage = &mut phases[duty.phase.0 as usize];
            for (place, rule) in duty.rules().enumerate() {
                let needs = rule.when.iter().filter_map(|condition| event(*condition));
                match rule.then {
                    Action::Magnetize { child, cell, .. } => {
                        stage
                            .needs
                            .entry(News::Anchored(child))
                            .or_default()
                            .extend(needs);
                        stage.captures.insert(child);
                        stage.cells.insert(cell);
                        cells.insert((duty.phase, child), cell);
                    }
                    Action::SwitchOff { child, .. } => {
                        stage
                            .needs
                            .entry(News::Released(child))
                            .or_default()
                            .extend(needs);
                        stage.releases.insert(child);
                    }
                    Action::Report => {
                        stage.reports.insert(Reporter {
                            role: duty.role,
                            trigger: duty.trigger,
                            rule: place as u32,
                        });
                    }
                    Action::AskRelease => {
                        let event = News::Released(duty.role);
                        stage.needs.entry(event).or_default().extend(needs);
                    }
                    Action::Tell { .. } => {}
                }
            }
        }
        let mut structure: BTreeMap<RoleId, Cell> = tables.seeds().collect();
        for (number, stage) in phases.iter_mut().enumerate() {
            let phase = PhaseId(number as u32);
            let held: BTreeSet<RoleId> = structure.keys().copied().collect();
            structure.retain(|role, _| !stage.releases.contains(role));
            for &role in &stage.captures {
                if held.contains(&role) || !stage.releases.contains(&role) {
                    structure.insert(role, cells[&(phase, role)]);
                }
            }
            stage.structure = structure.clone();
        }
        Expected { phases }
    }

    /// Who sits where when a phase has ended, seeds included.
    pub fn structure(&self, phase: PhaseId) -> &BTreeMap<RoleId, Cell> {
        &self.phases[phase.0 as usize].structure
    }

    /// Captures and releases of the phase that has most of them.
    pub fn widest(&self) -> usize {
        let events = |stage: &Stage| stage.captures.len() + stage.releases.len();
        self.phases.iter().map(events).max().unwrap_or(0)
    }
}

/// The event that a condition stands for.
fn event(condition: Condition) -> Option<News> {
    match condition {
        Condition::Docked(role) => Some(News::Anchored(role)),
        Condition::Released(role) => Some(News::Released(role)),
        Condition::Heard(news) => Some(news),
        Condition::Asked(_) => None,
    }
}
