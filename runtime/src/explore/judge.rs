//! What is wrong with a step, or with a state in which nothing can happen any more.
use std::collections::{BTreeMap, BTreeSet};

use stochc_ir::Cell;
use stochc_ir::table::{PhaseId, RoleId};

use super::bench::Effects;
use super::expected::{Expected, Stage};
use super::report::{Property, Verdict, Violation};
use super::state::{Setting, State};
use super::step::Step;
use super::story::Story;
use crate::control::message::Reporter;

/// A property that is violated, and how.
pub(super) type Wrong = (Property, String);

/// Judges by what is expected.
#[derive(Clone, Copy)]
pub(super) struct Judge<'a> {
    pub expected: &'a Expected,
    pub story: Story<'a>,
}

impl Judge<'_> {
    /// What is wrong with a step made in the state `before`.
    pub fn step(&self, before: &State<'_>, step: Step, effects: &Effects) -> Option<Wrong> {
        if let Some(wrong) = self.effects(effects) {
            return Some(wrong);
        }
        if step != Step::EndPhase {
            return None;
        }
        let stage = before.stage(self.expected)?;
        self.early_end(before, stage)
            .or_else(|| self.structure(before, stage))
            .or_else(|| self.reports(before, stage))
    }

    /// What is wrong with what a step has done, whatever came before.
    pub fn effects(&self, effects: &Effects) -> Option<Wrong> {
        let &(property, fault) = effects.faults.first()?;
        Some((property, self.story.fault(fault)))
    }

    /// What is wrong with a state in which nothing can happen any more.
    pub fn hang(&self, state: &State<'_>) -> Option<Wrong> {
        if state.is_complete() {
            return None;
        }
        let (phase, waits) = (self.story.phase(state), self.story.waits(state));
        Some((Property::NoHang, format!("{phase} never ends: {waits}")))
    }

    /// What is wrong with a state in which a block may dock where nobody expects it.
    pub fn unplanned(&self, setting: &Setting<'_>, state: &State<'_>) -> Option<Wrong> {
        // Faults bring strays of their own.
        if !setting.tables.bond.is_passive() || !setting.faults.is_none() {
            return None;
        }
        let site = state.unsettled(setting)?;
        let face = self.story.face_of(state, site);
        let what = format!("an unplanned bond on {face} is not undone");
        Some((Property::Unplanned, what))
    }

    /// The verdict on something wrong, with the steps that led there.
    pub fn violated(
        &self,
        setting: &Setting<'_>,
        (property, what): Wrong,
        phase: Option<PhaseId>,
        steps: &[Step],
    ) -> Verdict {
        Verdict::Violated(Box::new(Violation {
            property,
            phase: phase.unwrap_or(PhaseId(0)),
            what,
            trace: self.story.trace(setting, steps),
        }))
    }

    fn early_end(&self, state: &State<'_>, stage: &Stage) -> Option<Wrong> {
        let missing = |all: &BTreeSet<RoleId>, done: &BTreeSet<RoleId>| {
            self.story.names(all.difference(done))
        };
        let captures = missing(&stage.captures, &state.done.captures);
        let releases = missing(&stage.releases, &state.done.releases);
        let before = match (captures.as_str(), releases.as_str()) {
            ("", "") => return None,
            (captures, "") => format!("{captures} is captured"),
            ("", releases) => format!("{releases} is let go"),
            (captures, releases) => format!("{captures} is captured and {releases} let go"),
        };
        let phase = self.story.phase(state);
        Some((
            Property::NoEarlyEnd,
            format!("{phase} ends before {before}"),
        ))
    }

    fn structure(&self, state: &State<'_>, stage: &Stage) -> Option<Wrong> {
        let built: BTreeMap<RoleId, Cell> = (state.structure.blocks().iter())
            .filter_map(|(&body, block)| Some((block.role, state.lattice.place(body)?.cell)))
            .collect();
        let phase = self.story.phase(state);
        let wrong = |what: String| Some((Property::Structure, format!("{phase} ends {what}")));
        for (role, cell) in &stage.structure {
            let name = self.story.names([role]);
            match built.get(role) {
                None => return wrong(format!("without {name}")),
                Some(there) if there != cell => {
                    return wrong(format!("with {name} at {there}, which belongs at {cell}"));
                }
                Some(_) => {}
            }
        }
        for (role, cell) in &built {
            if !stage.structure.contains_key(role) {
                let name = self.story.names([role]);
                return wrong(format!("with {name} at {cell}, where nothing belongs"));
            }
        }
        let named: BTreeSet<Cell> = built.values().copied().collect();
        let stray = state
            .lattice
            .cells()
            .keys()
            .find(|cell| !named.contains(cell))?;
        wrong(format!("with a block without a name at {stray}"))
    }

    fn reports(&self, state: &State<'_>, stage: &Stage) -> Option<Wrong> {
        let phase = self.story.phase(state);
        let came: Vec<Reporter> = state.done.reports.clone();
        let wrong = |by: &Reporter, what: &str| {
            let name = self.story.names([&by.role]);
            let text = format!("{phase} ends {what} of {name}");
            Some((Property::ReportsOnce, text))
        };
        if let Some(twice) = came.windows(2).find(|pair| pair[0] == pair[1]) {
            return wrong(&twice[0], "with two copies of the report");
        }
        let set: BTreeSet<Reporter> = came.into_iter().collect();
        if let Some(by) = stage.reports.difference(&set).next() {
            return wrong(by, "without the report");
        }
        let by = set.difference(&stage.reports).next()?;
        wrong(by, "with a report too many,")
    }
}
