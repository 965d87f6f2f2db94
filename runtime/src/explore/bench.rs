//! What the structure decides, carried out in a state.
use stochc_ir::table::{News, RoleId};

use super::expected::Stage;
use super::faults::Faults;
use super::report::Property;
use super::state::Done;
use super::step::{Flight, Mute};
use crate::control::block::Open;
use crate::control::link::Links;
use crate::control::medium::{Capture, Medium, Recalled};
use crate::control::message::{Message, Reporter};
use crate::world::lattice::Lattice;
use crate::world::{Body, Docking, Site};

/// What a step has done besides changing the state.
#[derive(Debug, Default)]
pub(super) struct Effects {
    /// What went wrong.
    pub faults: Vec<(Property, Fault)>,
    /// Blocks that were let go: who held it, and who went.
    pub released: Vec<(RoleId, RoleId)>,
    /// Faces that were switched on.
    pub opened: Vec<Site>,
    /// Faces that were switched off.
    pub closed: Vec<Site>,
    /// Messages that made their first hop, or a further one, from a block.
    pub sent: Vec<(Body, Message)>,
    /// Reports that came to the plate.
    pub reports: u32,
    /// Blocks that were captured.
    pub captured: Vec<RoleId>,
}

/// What went wrong, before it is put into words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// A block was let go that holds others.
    Adrift(RoleId),
    /// A name was given that a block already has.
    SecondHolder(RoleId),
    /// An event happened before another one for which it should have waited.
    TooEarly(News, News),
    /// A block was captured before enough of those that its parent captures first.
    OutOfTurn(RoleId),
    /// A block has too many faces on.
    TooManyFaces(RoleId),
}

/// Carries out what the structure decides, and writes down what is of interest.
pub(super) struct Bench<'a> {
    pub faults: Faults,
    /// What the phase has to do; `None`: all phases have ended.
    pub stage: Option<&'a Stage>,
    /// From this number on, blocks have no role.
    pub first_stray: u32,
    pub lattice: &'a mut Lattice,
    pub under_way: &'a mut Vec<Flight>,
    pub links: &'a mut Links,
    pub done: &'a mut Done,
    pub effects: &'a mut Effects,
}

impl Bench<'_> {
    /// Notes an event, and what it should have waited for.
    fn happen(&mut self, event: News) {
        let needs = self.stage.and_then(|stage| stage.needs.get(&event));
        let missing = (needs.into_iter().flatten()).find(|needed| !self.done.has(**needed));
        if let Some(missing) = missing {
            let fault = Fault::TooEarly(event, *missing);
            self.effects.faults.push((Property::Order, fault));
        }
        let turn = self.stage.and_then(|stage| stage.turns.get(&event));
        if let (Some((needed, of)), News::Anchored(role)) = (turn, event)
            && of.iter().filter(|first| self.done.has(**first)).count() < *needed
        {
            let fault = Fault::OutOfTurn(role);
            self.effects.faults.push((Property::Order, fault));
        }
        match event {
            News::Anchored(role) => self.done.captures.insert(role),
            News::Released(role) => self.done.releases.insert(role),
        };
    }
}

impl Medium for Bench<'_> {
    fn magnetize(&mut self, site: Site, _by: RoleId, _open: &Open) {
        self.effects.opened.push(site);
        self.lattice.magnetize(site);
    }

    fn switch_off(&mut self, site: Site) {
        self.effects.closed.push(site);
        let held = self.lattice.held(site);
        let holds_stray = held.is_some_and(|id| id >= self.first_stray);
        if !(self.faults.stuck && holds_stray) {
            self.lattice.switch_off(site);
        }
    }

    fn send(&mut self, from: Body, to: Body, message: Message) {
        let mut number = 0;
        if self.faults.lost > 0 {
            number = self.links.send(from, to, message);
        }
        let flight = Flight {
            from,
            to,
            message,
            number: Mute(number),
            lost: 0,
            is_taken: false,
            is_waiting: false,
        };
        let i = self.under_way.partition_point(|other| *other <= flight);
        self.under_way.insert(i, flight);
        self.effects.sent.push((from, message));
    }

    fn recall(&mut self, gone: Body) -> Recalled {
        let touches = |flight: &mut Flight| flight.from == gone || flight.to == gone;
        let flights: Vec<Flight> = self.under_way.extract_if(.., touches).collect();
        if self.faults.lost > 0 && self.faults.sent_again {
            return self.links.close(gone);
        }
        let mut recalled = Recalled::default();
        for flight in flights {
            if flight.to == gone {
                recalled.to.push(flight.message);
            } else {
                recalled.from.push(flight.message);
            }
        }
        recalled
    }

    fn hush(&mut self) {
        self.under_way.clear();
        self.links.clear();
    }

    fn captured(&mut self, capture: &Capture, _docking: &Docking) {
        self.happen(News::Anchored(capture.child));
        self.effects.captured.push(capture.child);
    }

    fn released(&mut self, by: RoleId, role: RoleId, _body: Body, orphans: usize) {
        self.happen(News::Released(role));
        self.effects.released.push((by, role));
        if orphans > 0 {
            (self.effects.faults).push((Property::NoneAdrift, Fault::Adrift(role)));
        }
    }

    fn reported(&mut self, by: Reporter) {
        let i = self.done.reports.partition_point(|other| *other <= by);
        self.done.reports.insert(i, by);
        self.effects.reports += 1;
    }
}
