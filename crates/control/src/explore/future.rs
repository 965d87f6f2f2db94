//! Upper bound of the events in the rest of a phase, without some transitions.
//!
//! The bound ignores everything that can only delay an event: occupied cells, transit times, and
//! occupied names. The remaining rules are monotone. Applying them until nothing changes finds
//! every event that can happen in any order.
use std::collections::{BTreeMap, BTreeSet};

use stochc_ir::Cell;
use stochc_ir::table::{Action, Condition, Duty, Notification, PhaseId, RoleId, Tables, Trigger};

use super::context::ExplorationContext;
use super::roles::RoleSet;
use super::state::ProgramState;
use super::transition::Transition;
use crate::{BlockFace, Message, Payload, Recipient, StructureBlock};

/// Roles that may capture each role in a phase.
#[derive(Clone, Debug, Default)]
pub(super) struct PhaseCaptors {
    /// For each captured role, the roles with a rule to capture it.
    of: BTreeMap<RoleId, Vec<RoleId>>,
}

impl PhaseCaptors {
    pub fn by_phase(tables: &Tables) -> Vec<PhaseCaptors> {
        let mut all = vec![PhaseCaptors::default(); tables.phases.len()];
        for duty in tables.duties() {
            for rule in duty.rules() {
                if let Action::Magnetize { child, .. } = rule.then {
                    let of = &mut all[duty.phase.0 as usize].of;
                    of.entry(child).or_default().push(duty.role);
                }
            }
        }
        all
    }

    /// Returns whether a role has several possible captors.
    pub fn is_ambiguous(&self) -> bool {
        self.of.values().any(|captors| captors.len() > 1)
    }

    /// Adds a role and all its possible ancestors.
    pub fn add_lineage(&self, state: &ProgramState<'_>, role: RoleId, to: &mut RoleSet) {
        let mut open = vec![role];
        while let Some(role) = open.pop() {
            if !to.insert(role) {
                continue;
            }
            open.extend(self.of.get(&role).into_iter().flatten());
            let block = state.structure.holder(role);
            let parent = block.and_then(|block| state.structure.parent(block));
            open.extend(parent.map(StructureBlock::role));
        }
    }

    /// Adds all roles on the paths that a message at this role's block may take.
    pub fn add_path(
        &self,
        state: &ProgramState<'_>,
        at: RoleId,
        message: &Message,
        to: &mut RoleSet,
    ) {
        self.add_lineage(state, at, to);
        match message.target {
            Recipient::Plate => {}
            Recipient::Block(body) => {
                if let Some(role) = state.role(body) {
                    self.add_lineage(state, role, to);
                }
            }
            Recipient::Role(role) => self.add_lineage(state, role, to),
        }
    }
}

/// Everything that may happen in the rest of a phase.
#[derive(Clone, Debug)]
pub(super) struct Future {
    /// Largest number of reports at the plate.
    pub reports: u32,
    /// Cells that may be filled.
    pub cells: Vec<Cell>,
    /// Captures and releases that may happen.
    pub events: BTreeSet<Notification>,
    /// Blocks that may be released, and their parents.
    pub released: RoleSet,
    /// Blocks that may act or whose presence may matter.
    pub touched: RoleSet,
    /// Number of evaluated rules, for the work limit.
    pub looked_at: u64,
}

/// Rules of a duty that have not fired yet.
struct OpenDuty<'t> {
    duty: Duty<'t>,
    open: Vec<bool>,
}

struct Forecast<'a, 't> {
    tables: &'t Tables,
    phase: PhaseId,
    state: &'a ProgramState<'t>,
    captors: &'a PhaseCaptors,
    open_duties: Vec<OpenDuty<'t>>,
    anchored: RoleSet,
    asked: RoleSet,
    docked: RoleSet,
    released_roles: RoleSet,
    notified: BTreeSet<(RoleId, Notification)>,
    future: Future,
}

impl Future {
    /// Returns the bound for the running phase if none of the transitions `without` occurs. Returns
    /// `None` after the last phase.
    pub fn new<'t>(
        context: &ExplorationContext<'t>,
        captors: &PhaseCaptors,
        state: &ProgramState<'t>,
        without: &[Transition],
    ) -> Option<Future> {
        let phase = state.structure.phase()?;
        let tables = context.tables;
        let none = || RoleSet::none(tables.roles.len());
        let mut forecast = Forecast {
            tables,
            phase,
            state,
            captors,
            open_duties: Vec::new(),
            anchored: none(),
            asked: none(),
            docked: none(),
            released_roles: none(),
            notified: BTreeSet::new(),
            future: Future {
                reports: state.structure.reports(),
                cells: Vec::new(),
                events: BTreeSet::new(),
                released: none(),
                touched: none(),
                looked_at: state.structure.count() as u64,
            },
        };
        forecast.begin(without);
        while forecast.round() {}
        for &role in &context.struck.dead {
            if !without.contains(&Transition::Die(role)) {
                forecast.future.released.insert(role);
                forecast.future.touched.insert(role);
            }
        }
        Some(forecast.future)
    }
}

impl<'t> Forecast<'_, 't> {
    /// Adds the duties, observations, messages and open faces of the current state. Excludes the
    /// transitions `without`.
    fn begin(&mut self, without: &[Transition]) {
        let state = self.state;
        for block in state.structure.blocks() {
            let body = block.body();
            if let Some(duty) = self.tables.duty(block.role(), self.phase, block.trigger()) {
                let open = (0..duty.rules().len())
                    .map(|index| !block.has_fired(index))
                    .collect();
                self.open_duties.push(OpenDuty { duty, open });
            }
            for condition in block.seen() {
                match *condition {
                    Condition::Docked(role) => self.docked.insert(role),
                    Condition::Asked(role) => self.asked.insert(role),
                    Condition::Released(role) => self.released_roles.insert(role),
                    Condition::Notified(notification) => self.notify(block.role(), notification),
                    Condition::Turn(_) => false,
                };
            }
            for message in block.waiting() {
                self.arrive(block.role(), message);
            }
            for open in block.open() {
                let block_face = BlockFace {
                    body,
                    face: open.own,
                };
                if !without.contains(&Transition::Capture(block_face)) {
                    self.capture(block.role(), open.child, open.cell);
                }
            }
        }
        for transit in &state.in_transit {
            let is_without = without
                .iter()
                .any(|transition| transition.transit() == Some(*transit));
            if !is_without && let Some(at) = state.role(transit.to) {
                self.arrive(at, &transit.message);
            }
        }
    }

    /// Fires all rules that may fire. Returns whether a rule has fired.
    fn round(&mut self) -> bool {
        let mut changed = false;
        let mut i = 0;
        // Duties added during the loop are processed as well.
        while i < self.open_duties.len() {
            let duty = self.open_duties[i].duty;
            self.future.looked_at += duty.rules().len() as u64;
            for (index, rule) in duty.rules().enumerate() {
                let ready = self.open_duties[i].open[index]
                    && (rule.when.iter()).all(|&when| {
                        duty.is_true(index, when, |when| self.may_see(duty.role, when))
                    });
                if ready {
                    self.open_duties[i].open[index] = false;
                    self.fire(duty.role, rule.then);
                    changed = true;
                }
            }
            i += 1;
        }
        changed
    }

    fn may_see(&self, role: RoleId, condition: Condition) -> bool {
        match condition {
            Condition::Docked(child) => self.docked.contains(child),
            Condition::Asked(child) => self.asked.contains(child),
            Condition::Released(child) => self.released_roles.contains(child),
            Condition::Notified(notification) => self.notified.contains(&(role, notification)),
            // A turn is more than a single observation.
            Condition::Turn(_) => false,
        }
    }

    fn notify(&mut self, role: RoleId, notification: Notification) -> bool {
        self.notified.insert((role, notification))
    }

    fn fire(&mut self, role: RoleId, action: Action) {
        match action {
            Action::Magnetize { child, cell, .. } => self.capture(role, child, cell),
            Action::AskRelease | Action::AskReleaseLater(_) => {
                self.asked.insert(role);
                (self.captors).add_lineage(self.state, role, &mut self.future.touched);
            }
            Action::SwitchOff { child, .. } => {
                self.released_roles.insert(child);
                self.future.events.insert(Notification::Released(child));
                for role in [role, child] {
                    self.future.released.insert(role);
                    self.future.touched.insert(role);
                }
            }
            Action::Notify { to, notification } => {
                self.arrive(role, &Message::notify(to, notification))
            }
            Action::Report => {
                self.future.reports += 1;
                (self.captors).add_lineage(self.state, role, &mut self.future.touched);
            }
        }
    }

    fn capture(&mut self, parent: RoleId, child: RoleId, cell: Cell) {
        self.docked.insert(child);
        self.future.cells.push(cell);
        self.future.events.insert(Notification::Anchored(child));
        self.future.touched.insert(parent);
        self.future.touched.insert(child);
        if self.anchored.insert(child)
            && let Some(duty) = self.tables.duty(child, self.phase, Trigger::Anchored)
        {
            let open = vec![true; duty.rules().len()];
            self.open_duties.push(OpenDuty { duty, open });
        }
    }

    fn arrive(&mut self, at: RoleId, message: &Message) {
        (self.captors).add_path(self.state, at, message, &mut self.future.touched);
        match (message.payload, message.target) {
            (Payload::Report(_), _) => self.future.reports += 1,
            (Payload::Ask(child), _) => {
                self.asked.insert(child);
            }
            (Payload::Notify(notification), Recipient::Role(role)) => {
                self.notify(role, notification);
            }
            (Payload::Notify(_), _) => {}
        }
    }
}
