//! A state of a program: the structure, its cells, and all that is under way.
use std::collections::BTreeSet;

use stochc_ir::table::{News, RoleId, Tables};
use stochc_ir::{Cell, Face};

use super::bench::{Bench, Effects, Fault};
use super::expected::{Expected, Stage};
use super::faults::{Doom, Faults};
use super::report::Property;
use super::step::{Flight, Mute, Step};
use super::{Exploration, Reach};
use crate::control::link::Links;
use crate::control::message::Reporter;
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
    /// Numbers of transfers, where they may be lost; what they mean is written in the flights.
    pub links: Mute<Links>,
    /// What has happened in this phase, for judging its end.
    pub done: Done,
    /// The cells where strays have been.
    pub strayed: BTreeSet<Cell>,
}

/// What has happened in a phase.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Done {
    pub captures: BTreeSet<RoleId>,
    pub releases: BTreeSet<RoleId>,
    /// Sorted; a report that came twice is there twice.
    pub reports: Vec<Reporter>,
}

impl Done {
    /// Whether an event has happened in this phase.
    pub fn has(&self, event: News) -> bool {
        match event {
            News::Anchored(role) => self.captures.contains(&role),
            News::Released(role) => self.releases.contains(&role),
        }
    }
}

/// What does not change while a program is explored.
#[derive(Clone, Copy)]
pub(super) struct Setting<'a> {
    pub tables: &'a Tables,
    pub expected: &'a Expected,
    pub faults: Faults,
    pub reach: Option<&'a Reach<'a>>,
    pub doom: &'a Doom,
}

impl<'a> Setting<'a> {
    pub fn new(exploration: &Exploration<'a>, doom: &'a Doom) -> Setting<'a> {
        Setting {
            tables: exploration.tables,
            expected: exploration.expected,
            faults: exploration.faults,
            reach: exploration.reach,
            doom,
        }
    }
}

impl<'t> State<'t> {
    /// The beginning of the first phase.
    pub fn first(setting: &Setting<'t>) -> (State<'t>, Effects) {
        let mut state = State {
            structure: Structure::new(setting.tables),
            lattice: Lattice::default(),
            under_way: Vec::new(),
            links: Mute(Links::default()),
            done: Done::default(),
            strayed: BTreeSet::new(),
        };
        let mut effects = state.at_bench(setting, |structure, bench| structure.start(bench));
        // What is attached by hand is there when anything begins to happen.
        while state.structure.is_planting() {
            while let Some((site, _)) = state.structure.next_open() {
                effects
                    .faults
                    .append(&mut state.capture(setting, site, 0).faults);
            }
            let mut ended = state.make(setting, Step::EndPhase);
            effects.faults.append(&mut ended.faults);
        }
        (state, effects)
    }

    /// A face on which an unplanned bond would change something; `None`: wherever a block docks that
    /// nobody expects, it is rejected, and everything is as it was.
    ///
    /// Every exposed face is tried, one after the other.
    pub fn unsettled(&self, setting: &Setting<'t>) -> Option<Site> {
        let mut state = self.clone();
        let mut first = None;
        for (&body, block) in self.structure.blocks() {
            for face in Face::ALL {
                let site = Site { body, face };
                let is_open = block.open().iter().any(|open| open.own == face);
                if is_open || block.is_dead || self.lattice.target(site).is_none() {
                    continue;
                }
                first = first.or(Some(site));
                let docking = docking(site, setting.first_stray(), 0);
                state.lattice.dock(&docking);
                let effects =
                    state.at_bench(setting, |structure, bench| structure.dock(&docking, bench));
                let is_told = !effects.sent.is_empty()
                    || !effects.faults.is_empty()
                    || !effects.captured.is_empty()
                    || !effects.opened.is_empty();
                if is_told || effects.closed != [site] {
                    return Some(site);
                }
            }
        }
        first.filter(|_| state != *self)
    }

    /// Whether all phases have ended.
    pub fn is_complete(&self) -> bool {
        self.structure.phase().is_none()
    }

    /// What can happen next: first what messages do, then captures, the end of the phase last.
    pub fn steps(&self, setting: &Setting<'t>) -> Vec<Step> {
        let mut steps = Vec::new();
        if self.is_complete() {
            return steps;
        }
        for (i, &flight) in self.under_way.iter().enumerate() {
            if i > 0 && self.under_way[i - 1] == flight {
                continue;
            }
            if flight.is_waiting {
                steps.push(Step::SendAgain(flight));
                continue;
            }
            steps.push(Step::Arrive(flight));
            if flight.lost < setting.faults.lost {
                steps.push(Step::Lose(flight));
                steps.push(Step::LoseAnswer(flight));
            }
        }
        self.add_captures(setting, &mut steps);
        for &role in &setting.doom.dead {
            let holder = self.structure.holder(role);
            let block = holder.and_then(|body| self.structure.blocks().get(&body));
            if block.is_some_and(|block| !block.is_dead) {
                steps.push(Step::Die(role));
            }
        }
        if self.structure.is_phase_reported() {
            steps.push(Step::EndPhase);
        }
        steps
    }

    fn add_captures(&self, setting: &Setting<'t>, steps: &mut Vec<Step>) {
        let occupied = setting.reach.map(|_| self.occupied());
        let can_come = |cell| match (setting.reach, &occupied) {
            (Some(reach), Some(occupied)) => reach(occupied, cell),
            _ => true,
        };
        for &site in self.lattice.active() {
            let Some(_) = self.lattice.target(site).filter(|cell| can_come(*cell)) else {
                continue;
            };
            let child = self.opened(site);
            if child.is_some_and(|child| setting.doom.mistaken.contains(&child)) {
                steps.extend((1..24).map(|how| Step::CaptureMistaken(site, how)));
            } else {
                steps.push(Step::Capture(site));
            }
        }
        for &cell in &setting.doom.strays {
            if self.strayed.contains(&cell) || self.lattice.cells().contains_key(&cell) {
                continue;
            }
            for &body in self.structure.blocks().keys() {
                for face in Face::ALL {
                    let site = Site { body, face };
                    if self.lattice.target(site) == Some(cell)
                        && !self.lattice.active().contains(&site)
                        && can_come(cell)
                    {
                        steps.push(Step::Stray(site));
                    }
                }
            }
        }
    }

    /// The cells above the plate that hold a block.
    pub fn occupied(&self) -> BTreeSet<Cell> {
        self.lattice.cells().keys().copied().collect()
    }

    /// Makes a step that [`State::steps`] offers.
    pub fn make(&mut self, setting: &Setting<'t>, step: Step) -> Effects {
        match step {
            Step::Arrive(flight) => self.arrive(setting, flight, true),
            Step::LoseAnswer(flight) => self.arrive(setting, flight, false),
            Step::Lose(flight) => {
                self.remove(&flight);
                if setting.faults.sent_again {
                    self.insert(Flight {
                        lost: flight.lost + 1,
                        is_waiting: true,
                        ..flight
                    });
                }
                Effects::default()
            }
            Step::SendAgain(flight) => {
                self.remove(&flight);
                self.insert(Flight {
                    is_waiting: false,
                    ..flight
                });
                Effects::default()
            }
            Step::Capture(site) => self.capture(setting, site, 0),
            Step::CaptureMistaken(site, how) => self.capture(setting, site, how),
            Step::Stray(site) => {
                self.strayed.extend(self.lattice.target(site));
                let cell = self.lattice.target(site);
                let place = setting.doom.strays.iter().position(|at| Some(*at) == cell);
                let number = setting.first_stray() + place.unwrap_or(0) as u32;
                let docking = docking(site, number, 0);
                self.lattice.dock(&docking);
                self.at_bench(setting, |structure, bench| structure.dock(&docking, bench))
            }
            Step::Die(role) => {
                if let Some(body) = self.structure.holder(role) {
                    self.structure.kill(body);
                }
                Effects::default()
            }
            Step::EndPhase => {
                self.done = Done::default();
                let phase = self.structure.phase();
                let next = phase.map(|phase| phase.0 as usize + 1);
                self.at_bench_in(setting, next, |structure, bench| {
                    structure.next_phase(bench)
                })
            }
        }
    }

    fn arrive(&mut self, setting: &Setting<'t>, flight: Flight, is_answered: bool) -> Effects {
        self.remove(&flight);
        let Flight { from, to, .. } = flight;
        let number = flight.number.0;
        let with_losses = setting.faults.lost > 0;
        let is_dead = |body| {
            let block = self.structure.blocks().get(body);
            block.is_some_and(|block| block.is_dead)
        };
        // Nobody takes it or answers; to send it again for ever changes nothing.
        if with_losses && is_dead(&to) {
            return Effects::default();
        }
        let is_new = !with_losses || self.links.0.take(from, to, number);
        if is_answered && with_losses {
            self.links.0.acknowledge(from, to, number);
        } else if !is_answered && setting.faults.sent_again && !is_dead(&from) {
            self.insert(Flight {
                lost: flight.lost + 1,
                is_taken: true,
                is_waiting: true,
                ..flight
            });
        }
        if !is_new {
            return Effects::default();
        }
        self.at_bench(setting, |structure, bench| {
            structure.receive(to, flight.message, bench);
        })
    }

    fn remove(&mut self, flight: &Flight) {
        if let Ok(i) = self.under_way.binary_search(flight) {
            self.under_way.remove(i);
        }
    }

    fn insert(&mut self, flight: Flight) {
        let i = self.under_way.partition_point(|other| *other <= flight);
        self.under_way.insert(i, flight);
    }

    /// A block docks on a face that is on. It gets the number of its role, so that equal
    /// structures are equal states.
    fn capture(&mut self, setting: &Setting<'t>, site: Site, how: u8) -> Effects {
        let child = self.opened(site);
        let truth = docking(site, child.map_or(u32::MAX, |child| child.0), 0);
        let belief = docking(site, truth.child, how);
        let held = child.is_some_and(|child| self.structure.holder(child).is_some());
        self.lattice.dock(&truth);
        let mut effects = self.at_bench(setting, |structure, bench| structure.dock(&belief, bench));
        if let Some(child) = child.filter(|_| held) {
            let fault = Fault::SecondHolder(child);
            effects.faults.push((Property::OneHolder, fault));
        }
        effects
    }

    /// The role that a face that is on will give.
    fn opened(&self, site: Site) -> Option<RoleId> {
        let block = self.structure.blocks().get(&site.body)?;
        let open = block.open().iter().find(|open| open.own == site.face)?;
        Some(open.child)
    }

    fn at_bench(
        &mut self,
        setting: &Setting<'t>,
        act: impl FnOnce(&mut Structure<'t>, &mut Bench<'_>),
    ) -> Effects {
        let phase = self.structure.phase();
        let number = phase.map(|phase| phase.0 as usize);
        self.at_bench_in(setting, number, act)
    }

    /// The same in another phase: that of the events which the act brings.
    fn at_bench_in(
        &mut self,
        setting: &Setting<'t>,
        phase: Option<usize>,
        act: impl FnOnce(&mut Structure<'t>, &mut Bench<'_>),
    ) -> Effects {
        let mut effects = Effects::default();
        let mut bench = Bench {
            stage: phase.and_then(|phase| setting.expected.phases.get(phase)),
            faults: setting.faults,
            first_stray: setting.first_stray(),
            lattice: &mut self.lattice,
            under_way: &mut self.under_way,
            links: &mut self.links.0,
            done: &mut self.done,
            effects: &mut effects,
        };
        act(&mut self.structure, &mut bench);
        for site in &effects.opened {
            let block = self.structure.blocks().get(&site.body);
            let spare = usize::from(setting.tables.faces.max(1));
            if let Some(block) = block.filter(|block| block.open().len() > spare) {
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

impl Setting<'_> {
    /// From this number on, blocks have no role.
    fn first_stray(&self) -> u32 {
        self.tables.roles.len() as u32
    }
}

/// The docking of a block on a face; `how` is one of the 24 ways in which it may sit.
fn docking(site: Site, child: u32, how: u8) -> Docking {
    let how = (how + 5) % 24;
    Docking {
        site,
        child,
        child_face: Face::ALL[usize::from(how / 4)],
        turn: how % 4,
        entries: 1,
        entered: 0,
    }
}
