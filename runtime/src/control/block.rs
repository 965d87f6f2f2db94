//! What one anchored block keeps in mind.
use std::collections::BTreeMap;

use stochc_compiler::table::{Action, Condition, PhaseId, RoleId, Tables, Trigger};
use stochc_compiler::{Cell, Face};

use super::post::Message;
use crate::orientation::Orientation;
use crate::world::Body;

/// An anchored block: its name, how it sits, its neighbours in the tree, and its progress.
#[derive(Debug)]
pub(super) struct Block {
    pub role: RoleId,
    pub orientation: Orientation,
    /// The block that captured it; `None` for a seed.
    pub parent: Option<Body>,
    /// The blocks that it holds, each on a face of its own.
    pub children: BTreeMap<RoleId, (u32, Face)>,
    /// The faces that it has on and that hold nothing yet.
    pub open: Vec<Open>,
    /// Messages for blocks that will hang on it.
    pub waiting: Vec<Message>,
    trigger: Trigger,
    /// Which rules of its duty have fired, by their order.
    fired: Vec<bool>,
    /// What it has seen in this phase.
    seen: Vec<Condition>,
}

/// A face that is on.
#[derive(Debug)]
pub(super) struct Open {
    pub own: Face,
    /// The same face in the structure's frame.
    pub face: Face,
    pub child: RoleId,
    pub cell: Cell,
    pub since: u64,
}

impl Block {
    pub fn new(role: RoleId, orientation: Orientation, parent: Option<Body>) -> Block {
        Block {
            role,
            orientation,
            parent,
            children: BTreeMap::new(),
            open: Vec::new(),
            waiting: Vec::new(),
            trigger: Trigger::Start,
            fired: Vec::new(),
            seen: Vec::new(),
        }
    }

    /// Begins a duty, with nothing done and nothing seen.
    pub fn begin(&mut self, trigger: Trigger) {
        self.trigger = trigger;
        self.fired.clear();
        self.seen.clear();
        self.waiting.clear();
    }

    pub fn see(&mut self, condition: Condition) {
        if !self.seen.contains(&condition) {
            self.seen.push(condition);
        }
    }

    /// What it has heard and what waits at it, as messages to whoever has the role next.
    pub fn legacy(&self) -> Vec<Message> {
        let heard = self.seen.iter().filter_map(|&condition| match condition {
            Condition::Heard(news) => Some(Message::tell(self.role, news)),
            _ => None,
        });
        heard.chain(self.waiting.iter().cloned()).collect()
    }

    /// Takes a face from those that are on.
    pub fn close(&mut self, own: Face) -> Option<Open> {
        let i = self.open.iter().position(|open| open.own == own)?;
        Some(self.open.remove(i))
    }

    /// The next rule that is ready, which counts as fired from now on.
    pub fn next_action(&mut self, tables: &Tables, phase: PhaseId) -> Option<Action> {
        let duty = tables.duty(self.role, phase, self.trigger)?;
        self.fired.resize(duty.rules().len(), false);
        let seen = &self.seen;
        let (fired, rule) = self
            .fired
            .iter_mut()
            .zip(duty.rules())
            .find(|(fired, rule)| !**fired && rule.when.iter().all(|c| seen.contains(c)))?;
        *fired = true;
        Some(rule.then)
    }
}
