//! A state of a program: the structure, its cells, and all that is under way.
use std::collections::BTreeSet;

use stochc_compiler::table::{RoleId, Tables};
use stochc_compiler::{Cell, Face};

use super::Reach;
use super::expected::{Expected, Stage};
use super::report::Property;
use super::step::{Flight, Step};
use crate::control::medium::{Capture, Medium};
use crate::control::message::{Message, Reporter};
use crate::control::structure::Structure;
use crate::world::lattice::Lattice;
use crate::world::{Body, Docking, Site};

/// A state. Equal states have the same future.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct State<'t> {
    pub structure: Structure<'t>,
    pub lattice: Lattice,
    /// The hops that messages are making, sorted.
    pub under_way: Vec<Flight>,
    /// What has happened in this phase, for judging its end.
    pub done: Done,
}

/// What has happened in a phase.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Done {
    pub captures: BTreeSet<RoleId>,
    pub releases: BTreeSet<RoleId>,
    /// Sorted; a report that came twice is there twice.
    pub reports: Vec<Reporter>,
}

/// What a step has done besides changing the state.
#[derive(Debug, Default)]
pub(super) struct Effects {
    /// What went wrong.
    pub faults: Vec<(Property, Fault)>,
    /// Blocks that were let go: who held it, and who went.
    pub released: Vec<(RoleId, RoleId)>,
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
    /// A block has too many faces on.
    TooManyFaces(RoleId),
}

impl<'t> State<'t> {
    /// The beginning of the first phase.
    pub fn first(tables: &'t Tables) -> (State<'t>, Effects) {
        let mut state = State {
            structure: Structure::new(tables),
            lattice: Lattice::default(),
            under_way: Vec::new(),
            done: Done::default(),
        };
        let effects = state.with_bench(tables, |structure, bench| structure.start(bench));
        (state, effects)
    }

    /// Whether all phases have ended.
    pub fn is_complete(&self) -> bool {
        self.structure.phase().is_none()
    }

    /// What can happen next: arrivals, then captures, then the end of the phase.
    pub fn steps(&self, reach: Option<&Reach<'_>>) -> Vec<Step> {
        let mut steps: Vec<Step> = self.under_way.iter().copied().map(Step::Arrive).collect();
        steps.dedup();
        let occupied = reach.map(|_| self.occupied());
        let can_come = |cell| match (reach, &occupied) {
            (Some(reach), Some(occupied)) => reach(occupied, cell),
            _ => true,
        };
        steps.extend((self.lattice.active().iter().copied()).filter_map(|site| {
            let cell = self.lattice.target(site)?;
            can_come(cell).then_some(Step::Capture(site))
        }));
        if self.structure.is_phase_reported() {
            steps.push(Step::EndPhase);
        }
        steps
    }

    /// The cells above the plate that hold a block.
    pub fn occupied(&self) -> BTreeSet<Cell> {
        self.lattice.cells().keys().copied().collect()
    }

    /// Makes a step that [`State::steps`] offers.
    pub fn make(&mut self, tables: &'t Tables, step: Step) -> Effects {
        match step {
            Step::Arrive(flight) => {
                if let Ok(i) = self.under_way.binary_search(&flight) {
                    self.under_way.remove(i);
                }
                self.with_bench(tables, |structure, bench| {
                    structure.receive(flight.to, flight.message, bench);
                })
            }
            Step::Capture(site) => {
                let docking = self.docking(site);
                let role = RoleId(docking.child);
                let held = tables.roles.len() > docking.child as usize
                    && self.structure.holder(role).is_some();
                self.lattice.dock(&docking);
                let mut effects =
                    self.with_bench(tables, |structure, bench| structure.dock(&docking, bench));
                if held {
                    let fault = Fault::SecondHolder(role);
                    effects.faults.push((Property::OneHolder, fault));
                }
                effects
            }
            Step::EndPhase => {
                self.done = Done::default();
                self.with_bench(tables, |structure, bench| structure.next_phase(bench))
            }
        }
    }

    /// The docking of a block on a face. It gets the number of its role, so that equal structures
    /// are equal states, and always the same turn: tables speak of the structure's faces.
    fn docking(&self, site: Site) -> Docking {
        let block = self.structure.blocks().get(&site.body);
        let open = block.and_then(|block| block.open().iter().find(|open| open.own == site.face));
        Docking {
            site,
            child: open.map_or(u32::MAX, |open| open.child.0),
            child_face: Face::East,
            turn: 1,
            entries: 1,
            entered: 0,
        }
    }

    fn with_bench(
        &mut self,
        tables: &Tables,
        act: impl FnOnce(&mut Structure<'t>, &mut Bench<'_>),
    ) -> Effects {
        let mut effects = Effects::default();
        let mut bench = Bench {
            lattice: &mut self.lattice,
            under_way: &mut self.under_way,
            done: &mut self.done,
            effects: &mut effects,
        };
        act(&mut self.structure, &mut bench);
        for (&_, block) in self.structure.blocks() {
            if block.open().len() > usize::from(tables.faces.max(1)) {
                let fault = Fault::TooManyFaces(block.role);
                effects.faults.push((Property::Faces, fault));
            }
        }
        effects
    }

    /// The role of a block that is part of the structure.
    pub fn role(&self, body: Body) -> Option<RoleId> {
        Some(self.structure.blocks().get(&body)?.role)
    }

    /// What the phase that is running has to do.
    pub fn stage<'e>(&self, expected: &'e Expected) -> Option<&'e Stage> {
        expected.phases.get(self.structure.phase()?.0 as usize)
    }

    /// About how many bytes the state takes.
    pub fn weight(&self) -> usize {
        let of = std::mem::size_of::<State<'_>>();
        of + self.structure.blocks().len() * 512
            + self.under_way.len() * std::mem::size_of::<Flight>()
    }
}

/// Carries out what the structure decides, and writes down what is of interest.
struct Bench<'a> {
    lattice: &'a mut Lattice,
    under_way: &'a mut Vec<Flight>,
    done: &'a mut Done,
    effects: &'a mut Effects,
}

impl Medium for Bench<'_> {
    fn magnetize(&mut self, site: Site) {
        self.lattice.magnetize(site);
    }

    fn switch_off(&mut self, site: Site) {
        self.lattice.switch_off(site);
        self.effects.closed.push(site);
    }

    fn send(&mut self, from: Body, to: Body, message: Message) {
        let flight = Flight { from, to, message };
        let i = self.under_way.partition_point(|other| *other <= flight);
        self.under_way.insert(i, flight);
        self.effects.sent.push((from, message));
    }

    fn recall(&mut self, gone: Body) -> Vec<Message> {
        let recalled = self.under_way.extract_if(.., |flight| flight.to == gone);
        recalled.map(|flight| flight.message).collect()
    }

    fn hush(&mut self) {
        self.under_way.clear();
    }

    fn captured(&mut self, capture: &Capture, _docking: &Docking) {
        self.done.captures.insert(capture.child);
        self.effects.captured.push(capture.child);
    }

    fn released(&mut self, by: RoleId, role: RoleId, _body: Body, orphans: usize) {
        self.done.releases.insert(role);
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
