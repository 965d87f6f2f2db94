//! Environment that applies the structure's decisions to a state.
use stochc_ir::table::{Notification, RoleId};

use super::effects::{Effects, Mistake};
use super::expected::PhaseGoal;
use super::faults::Faults;
use super::progress::PhaseProgress;
use super::report::Property;
use super::transition::{Ignored, InTransit};
use crate::{
    BlockFace, Body, Channels, Docking, Environment, Lattice, Message, PlannedCapture, Recalled,
    Reporter,
};

/// Environment that applies the structure's decisions and records their effects.
pub(super) struct StateEnvironment<'a> {
    pub faults: Faults,
    /// Goal of the phase. `None` if all phases have ended.
    pub stage: Option<&'a PhaseGoal>,
    /// Number of the first stray block. Smaller numbers belong to blocks in roles.
    pub first_stray: u32,
    pub lattice: &'a mut Lattice,
    pub in_transit: &'a mut Vec<InTransit>,
    pub channels: &'a mut Channels,
    pub done: &'a mut PhaseProgress,
    pub effects: &'a mut Effects,
}

impl StateEnvironment<'_> {
    /// Records an event and checks its predecessors.
    fn happen(&mut self, event: Notification) {
        let needs = self.stage.and_then(|stage| stage.needs.get(&event));
        let missing = (needs.into_iter().flatten()).find(|needed| !self.done.has(**needed));
        if let Some(missing) = missing {
            let fault = Mistake::TooEarly(event, *missing);
            self.effects.faults.push((Property::Order, fault));
        }
        let turn = self.stage.and_then(|stage| stage.turns.get(&event));
        if let (Some((needed, of)), Notification::Anchored(role)) = (turn, event)
            && of.iter().filter(|first| self.done.has(**first)).count() < *needed
        {
            let fault = Mistake::OutOfTurn(role);
            self.effects.faults.push((Property::Order, fault));
        }
        match event {
            Notification::Anchored(role) => self.done.captures.insert(role),
            Notification::Released(role) => self.done.releases.insert(role),
        };
    }
}

impl Environment for StateEnvironment<'_> {
    type Mark = ();

    fn magnetize(&mut self, block_face: BlockFace, _capture: &PlannedCapture) {
        self.effects.opened.push(block_face);
        self.lattice.magnetize(block_face);
    }

    fn switch_off(&mut self, block_face: BlockFace) {
        self.effects.closed.push(block_face);
        let held = self.lattice.held(block_face);
        let holds_stray = held.is_some_and(|id| id >= self.first_stray);
        if !(self.faults.stuck && holds_stray) {
            self.lattice.switch_off(block_face);
        }
    }

    fn send(&mut self, from: Body, to: Body, message: Message) {
        let mut number = 0;
        if self.faults.lost > 0 {
            number = self.channels.send(from, to, message);
        }
        let transit = InTransit {
            from,
            to,
            message,
            number: Ignored(number),
            lost: 0,
            is_taken: false,
            is_waiting: false,
        };
        let i = self.in_transit.partition_point(|other| *other <= transit);
        self.in_transit.insert(i, transit);
        self.effects.sent.push((from, message));
    }

    fn recall(&mut self, left: Body, _unreceived: u32) -> Recalled {
        let touches = |transit: &mut InTransit| transit.from == left || transit.to == left;
        let transits: Vec<InTransit> = self.in_transit.extract_if(.., touches).collect();
        if self.faults.lost > 0 && self.faults.sent_again {
            return self.channels.close(left);
        }
        let mut recalled = Recalled::default();
        for transit in transits {
            if transit.to == left {
                recalled.to.push(transit.message);
            } else {
                recalled.from.push(transit.message);
            }
        }
        recalled
    }

    fn clear_messages(&mut self) {
        self.in_transit.clear();
        self.channels.clear();
    }

    fn captured(&mut self, capture: &PlannedCapture, _docking: &Docking, _mark: ()) {
        self.happen(Notification::Anchored(capture.child));
        self.effects.captured.push(capture.child);
    }

    fn released(&mut self, by: RoleId, role: RoleId, _body: Body, orphans: usize) {
        self.happen(Notification::Released(role));
        self.effects.released.push((by, role));
        if orphans > 0 {
            (self.effects.faults).push((Property::NoneAdrift, Mistake::Adrift(role)));
        }
    }

    fn reported(&mut self, by: Reporter) {
        let i = self.done.reports.partition_point(|other| *other <= by);
        self.done.reports.insert(i, by);
        self.effects.reports += 1;
    }
}
