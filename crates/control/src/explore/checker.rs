//! Checks of the properties after transitions, and in states without further transitions.
use std::collections::{BTreeMap, BTreeSet};

use stochc_ir::Cell;
use stochc_ir::table::{Action, PhaseId, RoleId, Rule, Trigger};

use super::context::ExplorationContext;
use super::describe::Describer;
use super::effects::Effects;
use super::expected::{PhaseGoal, ProgramGoals};
use super::report::{ExplorationVerdict, Property, Violation};
use super::state::ProgramState;
use super::transition::Transition;
use crate::Reporter;

/// Violated property, with a description.
pub(super) type Breach = (Property, String);

/// Checker of states and transitions against the program's goals.
#[derive(Clone, Copy)]
pub(super) struct PropertyChecker<'a> {
    pub expected: &'a ProgramGoals,
    pub describer: Describer<'a>,
}

impl PropertyChecker<'_> {
    /// Returns the property that a transition from the state `before` violates. Returns `None` if
    /// it violates none.
    pub fn transition(
        &self,
        before: &ProgramState<'_>,
        transition: Transition,
        effects: &Effects,
    ) -> Option<Breach> {
        if let Some(violation) = self.effects(effects) {
            return Some(violation);
        }
        match transition {
            Transition::EndPhase => {
                let stage = before.stage(self.expected)?;
                let is_wrong = |what| (Property::Structure, format!("ends {what}"));
                self.early_end(before, stage)
                    .or_else(|| self.structure(before, &stage.structure).map(is_wrong))
                    .map(|(property, what)| {
                        (property, format!("{} {what}", self.describer.phase(before)))
                    })
                    .or_else(|| self.reports(before, stage))
            }
            Transition::Retry => self.retry(before),
            _ => None,
        }
    }

    /// Returns the property that the effects of a transition violate, independently of the previous
    /// state. Returns `None` if they violate none.
    pub fn effects(&self, effects: &Effects) -> Option<Breach> {
        let &(property, fault) = effects.faults.first()?;
        Some((property, self.describer.fault(fault)))
    }

    /// Returns the property that a state violates if none of its transitions is certain. Returns
    /// `None` if it violates none.
    pub fn hang(&self, state: &ProgramState<'_>, transitions: &[Transition]) -> Option<Breach> {
        if state.is_complete() || transitions.iter().any(Transition::is_certain) {
            return None;
        }
        let (phase, waits) = (self.describer.phase(state), self.describer.waits(state));
        Some((Property::NoHang, format!("{phase} never ends: {waits}")))
    }

    /// Returns a violation if an unplanned capture would have lasting effects in a state.
    pub fn unplanned(
        &self,
        context: &ExplorationContext<'_>,
        state: &ProgramState<'_>,
    ) -> Option<Breach> {
        // Faces that are off may capture a block while a phase is aborted.
        let may_bond = context.tables.bond.is_passive() || state.structure.is_aborting();
        // Explorations with faults have their own stray blocks.
        if !may_bond || !context.faults.is_none() {
            return None;
        }
        let block_face = state.unsettled(context)?;
        let face = self.describer.face_of(state, block_face);
        let what = format!("an unplanned bond on {face} is not undone");
        Some((Property::Unplanned, what))
    }

    /// Returns the verdict for a violation, with the transitions that lead to it.
    pub fn violated(
        &self,
        context: &ExplorationContext<'_>,
        (property, what): Breach,
        phase: Option<PhaseId>,
        transitions: &[Transition],
    ) -> ExplorationVerdict {
        ExplorationVerdict::Violated(Box::new(Violation {
            property,
            phase: phase.unwrap_or(PhaseId(0)),
            what,
            trace: self.describer.trace(context, transitions),
            faults: (transitions.iter().enumerate())
                .filter(|(_, transition)| transition.is_fault())
                .map(|(at, _)| at)
                .collect(),
        }))
    }

    fn early_end(&self, state: &ProgramState<'_>, stage: &PhaseGoal) -> Option<Breach> {
        let missing = |all: &BTreeSet<RoleId>, done: &BTreeSet<RoleId>| {
            self.describer.names(all.difference(done))
        };
        let captures = missing(&stage.captures, &state.done.captures);
        let releases = missing(&stage.releases, &state.done.releases);
        let before = match (captures.as_str(), releases.as_str()) {
            ("", "") => return None,
            (captures, "") => format!("{captures} is captured"),
            ("", releases) => format!("{releases} is released"),
            (captures, releases) => format!("{captures} is captured and {releases} released"),
        };
        Some((Property::NoEarlyEnd, format!("ends before {before}")))
    }

    /// Returns the difference between the structure and a goal: `without C`. Returns `None` if
    /// they are equal.
    fn structure(&self, state: &ProgramState<'_>, goal: &BTreeMap<RoleId, Cell>) -> Option<String> {
        let built: BTreeMap<RoleId, Cell> = (state.structure.blocks())
            .filter_map(|block| {
                let placed = state.lattice.pose(block.body())?;
                Some((block.role(), placed.cell))
            })
            .collect();
        for (role, cell) in goal {
            let name = self.describer.names([role]);
            match built.get(role) {
                None => return Some(format!("without {name}")),
                Some(there) if there != cell => {
                    return Some(format!("with {name} at {there} instead of {cell}"));
                }
                Some(_) => {}
            }
        }
        for (role, cell) in &built {
            if !goal.contains_key(role) {
                let name = self.describer.names([role]);
                return Some(format!("with {name} at {cell}, which must be empty"));
            }
        }
        let named: BTreeSet<Cell> = built.values().copied().collect();
        let stray = state
            .lattice
            .cells()
            .keys()
            .find(|cell| !named.contains(cell))?;
        Some(format!("with a block without a role at {stray}"))
    }

    /// Returns a violation if an aborted phase begins again in another state than at its start.
    fn retry(&self, state: &ProgramState<'_>) -> Option<Breach> {
        let phase = state.structure.phase()?;
        let tables = self.describer.tables;
        let start = match (phase.0 as usize).checked_sub(1) {
            Some(before) => self.expected.phases[before].structure.clone(),
            None => tables.seeds().collect(),
        };
        let open = state.lattice.active().first();
        let open = open.map(|face| {
            let face = self.describer.face_of(state, *face);
            format!("while {face} is on")
        });
        let captors = tables.duties().filter(|duty| {
            let captures = |rule: Rule<'_>| matches!(rule.then, Action::Magnetize { .. });
            (duty.phase, duty.trigger) == (phase, Trigger::Start) && duty.rules().any(captures)
        });
        let captors: Vec<RoleId> = captors.map(|duty| duty.role).collect();
        let reported: Vec<RoleId> = state.done.reports.iter().map(|by| by.role).collect();
        let wrong_reports =
            (reported != captors).then(|| "without one report of each captor".to_owned());
        let what = (self.structure(state, &start)).or(open).or(wrong_reports)?;
        let phase = self.describer.phase(state);
        Some((Property::Recovery, format!("{phase} begins again {what}")))
    }

    fn reports(&self, state: &ProgramState<'_>, stage: &PhaseGoal) -> Option<Breach> {
        let phase = self.describer.phase(state);
        let came: Vec<Reporter> = state.done.reports.clone();
        let violation = |by: &Reporter, what: &str| {
            let name = self.describer.names([&by.role]);
            let text = format!("{phase} ends {what} of {name}");
            Some((Property::ReportsOnce, text))
        };
        if let Some(twice) = came.windows(2).find(|pair| pair[0] == pair[1]) {
            return violation(&twice[0], "with two copies of the report");
        }
        let set: BTreeSet<Reporter> = came.into_iter().collect();
        if let Some(by) = stage.reports.difference(&set).next() {
            return violation(by, "without the report");
        }
        let by = set.difference(&stage.reports).next()?;
        violation(by, "with an extra report,")
    }
}
