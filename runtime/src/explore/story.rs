//! Steps in the program's own words.
use stochc_ir::table::{News, RoleId, Tables};

use super::bench::{Effects, Fault};
use super::state::{Setting, State};
use super::step::{Flight, Step};
use crate::control::message::{Message, Payload, Target};
use crate::world::{Body, Site};

/// Tells of one program.
#[derive(Clone, Copy)]
pub(super) struct Story<'t> {
    pub tables: &'t Tables,
}

impl Story<'_> {
    /// Steps from the beginning, one line each.
    pub fn trace(&self, setting: &Setting<'_>, steps: &[Step]) -> Vec<String> {
        let (mut state, _) = State::first(setting);
        let mut lines = Vec::new();
        for &step in steps {
            let before = state.clone();
            let effects = state.make(setting, step);
            lines.push(self.tell(&before, step, &effects));
        }
        lines
    }

    fn name(&self, role: RoleId) -> &str {
        self.tables.name(role)
    }

    fn body(&self, state: &State<'_>, body: Body) -> String {
        match state.role(body) {
            Some(role) => self.name(role).to_owned(),
            None => "a block that has gone".to_owned(),
        }
    }

    /// The name of the running phase.
    pub fn phase(&self, state: &State<'_>) -> String {
        let phase = state.structure.phase();
        let name = phase.map(|phase| self.tables.phases[phase.0 as usize].name.as_str());
        format!("phase {}", name.unwrap_or("behind the last"))
    }

    /// A step in the state in which it was made, and what came of it.
    pub fn tell(&self, before: &State<'_>, step: Step, effects: &Effects) -> String {
        let mut line = match step {
            Step::Capture(site) => match self.face(before, site) {
                Some((parent, face, child)) => {
                    format!("{}.{face} captures {}", self.name(parent), self.name(child))
                }
                None => "a face that is off captures a block".to_owned(),
            },
            Step::Arrive(flight) => self.arrival(before, flight, effects),
            Step::CaptureMistaken(site, _) => match self.face(before, site) {
                Some((parent, face, child)) => format!(
                    "{}.{face} captures {}, which is mistaken about how it sits",
                    self.name(parent),
                    self.name(child)
                ),
                None => "a face that is off captures a block".to_owned(),
            },
            Step::Lose(flight) => {
                let (what, from, to) = self.hop(before, flight);
                format!("{what} is lost between {from} and {to}")
            }
            Step::LoseAnswer(flight) => {
                let (_, from, to) = self.hop(before, flight);
                let arrival = self.arrival(before, flight, effects);
                format!("{arrival}, and the acknowledgement of {to} to {from} is lost")
            }
            Step::SendAgain(flight) => {
                let (what, from, to) = self.hop(before, flight);
                format!("{from} sends {what} to {to} again")
            }
            Step::Stray(site) => {
                let face = self.face_of(before, site);
                format!("a block docks on {face}, which is off")
            }
            Step::Die(role) => format!("{} dies", self.name(role)),
            Step::EndPhase => format!("the plate ends {}", self.phase(before)),
        };
        for &(by, role) in &effects.released {
            line.push_str(&format!(", {} lets {} go", self.name(by), self.name(role)));
        }
        line
    }

    /// A face by the name of its block: `A.up`.
    pub fn face_of(&self, state: &State<'_>, site: Site) -> String {
        let face = state.lattice.place(site.body).map(|p| p.orientation);
        let face = face.map_or("", |seat| seat.to_structure(site.face).word());
        format!("{}.{face}", self.body(state, site.body))
    }

    /// What is on its way, from whom and to whom.
    fn hop(&self, state: &State<'_>, flight: Flight) -> (String, String, String) {
        let what = self.message(&flight.message);
        (
            what,
            self.body(state, flight.from),
            self.body(state, flight.to),
        )
    }

    fn arrival(&self, before: &State<'_>, flight: Flight, effects: &Effects) -> String {
        let what = self.message(&flight.message);
        let at = self.body(before, flight.to);
        if effects.reports > 0 {
            let count = before.structure.reports() + effects.reports;
            return format!("{what} reaches the plate, which has {count} now");
        }
        if effects
            .sent
            .iter()
            .any(|(_, message)| *message == flight.message)
        {
            return format!("{what} passes {at}");
        }
        let block = before.structure.blocks().get(&flight.to);
        if block.is_some_and(|block| block.is_dead) {
            return format!("{what} ends at {at}, which is dead");
        }
        if flight.is_taken {
            return format!("{at} drops {what}, which it has had before");
        }
        format!("{what} reaches {at}")
    }

    /// A message in words: `the report of C`.
    pub fn message(&self, message: &Message) -> String {
        let news = |news| self.news(news);
        match (message.payload, message.target) {
            (Payload::Report(by), _) => format!("the report of {}", self.name(by.role)),
            (Payload::Ask(role), _) => format!("the request of {} to be let go", self.name(role)),
            (Payload::Tell(what), Target::Role(to)) => {
                format!("the news for {} that {}", self.name(to), news(what))
            }
            (Payload::Tell(what), _) => format!("the news that {}", news(what)),
        }
    }

    fn news(&self, news: News) -> String {
        match news {
            News::Anchored(role) => format!("{} is anchored", self.name(role)),
            News::Released(role) => format!("{} is released", self.name(role)),
        }
    }

    /// Whose face it is, which, and whom it waits for.
    fn face(&self, state: &State<'_>, site: Site) -> Option<(RoleId, stochc_ir::Face, RoleId)> {
        let block = state.structure.blocks().get(&site.body)?;
        let open = block.open().iter().find(|open| open.own == site.face)?;
        Some((block.role, open.face, open.child))
    }

    /// What a fault of a step is.
    pub fn fault(&self, fault: Fault) -> String {
        match fault {
            Fault::Adrift(role) => {
                format!("{} is let go while it holds another block", self.name(role))
            }
            Fault::SecondHolder(role) => {
                format!(
                    "{} is captured while another block has its name",
                    self.name(role)
                )
            }
            Fault::TooEarly(event, missing) => {
                format!("{} before {}", self.news(event), self.news(missing))
            }
            Fault::OutOfTurn(role) => {
                format!(
                    "{} is captured before enough of those that its parent captures first",
                    self.name(role)
                )
            }
            Fault::TooManyFaces(role) => {
                format!(
                    "{} magnetizes more faces than it has to spare",
                    self.name(role)
                )
            }
        }
    }

    /// What a state still waits for in which nothing can happen any more.
    pub fn waits(&self, state: &State<'_>) -> String {
        let mut waits: Vec<String> = Vec::new();
        for (&body, block) in state.structure.blocks() {
            for open in block.open() {
                let site = Site {
                    body,
                    face: open.own,
                };
                let why = match state.lattice.target(site) {
                    Some(_) => "to which no block can come",
                    None => "which is full",
                };
                waits.push(format!(
                    "{}.{} waits for {} at {}, {why}",
                    self.name(block.role),
                    open.face,
                    self.name(open.child),
                    open.cell
                ));
            }
        }
        if waits.is_empty() {
            let has = state.structure.reports();
            let phase = state.structure.phase();
            let needs = phase.map_or(0, |phase| self.tables.phases[phase.0 as usize].reports);
            waits.push(format!("the plate has {has} of {needs} reports"));
        }
        waits.join("; ")
    }

    /// Names, with commas.
    pub fn names<'r>(&self, roles: impl IntoIterator<Item = &'r RoleId>) -> String {
        let names: Vec<&str> = roles.into_iter().map(|role| self.name(*role)).collect();
        names.join(", ")
    }
}
