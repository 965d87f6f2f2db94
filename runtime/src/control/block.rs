//! What one anchored block keeps in mind.
use std::collections::BTreeMap;

use stochc_ir::table::{Action, Condition, PhaseId, RoleId, Tables, Trigger};
use stochc_ir::{Cell, Face};

use super::message::Message;
use crate::orientation::Orientation;
use crate::world::Body;

/// An anchored block: its name, how it sits, its neighbours in the tree, and its progress.
///
/// Its lists are sorted: what a block knows does not depend on the order in which it came to know.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Block {
    pub role: RoleId,
    pub orientation: Orientation,
    /// The block that captured it; `None` for a seed.
    pub parent: Option<Body>,
    /// The blocks that it holds, each on a face of its own.
    pub children: BTreeMap<RoleId, (u32, Face)>,
    /// The faces that it has on and that hold nothing yet, sorted.
    open: Vec<Open>,
    /// Messages for blocks that will hang on it, sorted.
    waiting: Vec<Message>,
    trigger: Trigger,
    /// Which rules of its duty have fired, by their order.
    fired: Vec<bool>,
    /// What it has seen in this phase, sorted.
    seen: Vec<Condition>,
    /// It neither acts nor passes anything on, and what it knew is lost.
    pub is_dead: bool,
}

/// A face that is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Open {
    pub own: Face,
    /// The same face in the structure's frame.
    pub face: Face,
    pub child: RoleId,
    pub cell: Cell,
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
            is_dead: false,
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
        if let Err(i) = self.seen.binary_search(&condition) {
            self.seen.insert(i, condition);
        }
    }

    /// Keeps a message for a block that will hang on it.
    pub fn keep(&mut self, message: Message) {
        let i = self.waiting.partition_point(|other| *other <= message);
        self.waiting.insert(i, message);
    }

    /// Takes out all that waits.
    pub fn take_waiting(&mut self) -> Vec<Message> {
        std::mem::take(&mut self.waiting)
    }

    /// What it has heard and what waits at it, as messages to whoever has the role next.
    pub fn legacy(&self) -> Vec<Message> {
        if self.is_dead {
            return Vec::new();
        }
        let heard = self.seen.iter().filter_map(|&condition| match condition {
            Condition::Heard(news) => Some(Message::tell(self.role, news)),
            _ => None,
        });
        heard.chain(self.waiting.iter().copied()).collect()
    }

    /// Adds a face to those that are on.
    pub fn switch_on(&mut self, open: Open) {
        let i = self.open.partition_point(|other| *other <= open);
        self.open.insert(i, open);
    }

    /// Takes a face from those that are on.
    pub fn close(&mut self, own: Face) -> Option<Open> {
        let i = self.open.iter().position(|open| open.own == own)?;
        Some(self.open.remove(i))
    }

    /// The faces that are on and hold nothing.
    pub fn open(&self) -> &[Open] {
        &self.open
    }

    /// What it has seen, sorted.
    pub fn seen(&self) -> &[Condition] {
        &self.seen
    }

    /// The messages that wait at it, sorted.
    pub fn waiting(&self) -> &[Message] {
        &self.waiting
    }

    /// When its duty began.
    pub fn trigger(&self) -> Trigger {
        self.trigger
    }

    /// Whether a rule of its duty has fired.
    pub fn has_fired(&self, rule: usize) -> bool {
        self.fired.get(rule).is_some_and(|fired| *fired)
    }

    /// The next rule that is ready, by its place in the duty; it counts as fired from now on.
    pub fn next_action(&mut self, tables: &Tables, phase: PhaseId) -> Option<(u32, Action)> {
        if self.is_dead {
            return None;
        }
        let duty = tables.duty(self.role, phase, self.trigger)?;
        self.fired.resize(duty.rules().len(), false);
        let seen = &self.seen;
        let (place, rule) = duty.rules().enumerate().find(|(place, rule)| {
            !self.fired[*place]
                && (rule.when.iter()).all(|&when| {
                    duty.is_true(*place, when, |when| seen.binary_search(&when).is_ok())
                })
        })?;
        self.fired[place] = true;
        Some((place as u32, rule.then))
    }
}
