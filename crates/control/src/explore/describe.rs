//! Descriptions of steps in the names of the program.
use stochc_ir::table::{Notification, RoleId, Tables};

use super::context::ExplorationContext;
use super::effects::{Effects, Mistake};
use super::state::ProgramState;
use super::transition::{InTransit, Transition};
use crate::{BlockFace, Body, Message, Payload, Recipient};

#[derive(Clone, Copy)]
pub(super) struct Describer<'t> {
    pub tables: &'t Tables,
}

impl Describer<'_> {
    /// Describes the steps from the start, one line each.
    pub fn trace(
        &self,
        context: &ExplorationContext<'_>,
        transitions: &[Transition],
    ) -> Vec<String> {
        let (mut state, _) = ProgramState::first(context);
        let mut lines = Vec::new();
        for &transition in transitions {
            let before = state.clone();
            let effects = state.make(context, transition);
            lines.push(self.transition(&before, transition, &effects));
        }
        lines
    }

    fn name(&self, role: RoleId) -> &str {
        self.tables.name(role)
    }

    fn body(&self, state: &ProgramState<'_>, body: Body) -> String {
        match state.role(body) {
            Some(role) => self.name(role).to_owned(),
            None => "a removed block".to_owned(),
        }
    }

    pub fn phase(&self, state: &ProgramState<'_>) -> String {
        let phase = state.structure.phase();
        let name = phase.map(|phase| self.tables.phases[phase.0 as usize].name.as_str());
        format!("phase {}", name.unwrap_or("after the last"))
    }

    pub fn transition(
        &self,
        before: &ProgramState<'_>,
        transition: Transition,
        effects: &Effects,
    ) -> String {
        let mut line = match transition {
            Transition::Capture(block_face) => match self.face(before, block_face) {
                Some((parent, face, child)) => {
                    format!("{}.{face} captures {}", self.name(parent), self.name(child))
                }
                None => "a face that is off captures a block".to_owned(),
            },
            Transition::Hold(block_face) => match self.face(before, block_face) {
                Some((parent, face, child)) => format!(
                    "{}.{face} captures a block for {}, which does not answer",
                    self.name(parent),
                    self.name(child)
                ),
                None => "a face that is off captures a block".to_owned(),
            },
            Transition::Answer(block_face) => match self.face(before, block_face) {
                Some((_, _, child)) => format!("{} answers late", self.name(child)),
                None => "a released block answers".to_owned(),
            },
            Transition::Arrive(transit) => self.arrival(before, transit, effects),
            Transition::CaptureMistaken(block_face, _) => match self.face(before, block_face) {
                Some((parent, face, child)) => format!(
                    "{}.{face} captures {}, which misjudges its orientation",
                    self.name(parent),
                    self.name(child)
                ),
                None => "a face that is off captures a block".to_owned(),
            },
            Transition::Lose(transit) => {
                let (what, from, to) = self.hop(before, transit);
                format!("{what} is lost between {from} and {to}")
            }
            Transition::LoseAnswer(transit) => {
                let (_, from, to) = self.hop(before, transit);
                let arrival = self.arrival(before, transit, effects);
                format!("{arrival}, and the acknowledgement of {to} to {from} is lost")
            }
            Transition::SendAgain(transit) => {
                let (what, from, to) = self.hop(before, transit);
                format!("{from} sends {what} to {to} again")
            }
            Transition::Stray(block_face) => {
                let face = self.face_of(before, block_face);
                format!("{face} captures a block, though it is off")
            }
            Transition::Die(role) => format!("{} dies", self.name(role)),
            Transition::EndPhase => format!("the plate ends {}", self.phase(before)),
            Transition::Abort => format!("{} reaches its timeout", self.phase(before)),
            Transition::Retry => format!("the plate begins {} again", self.phase(before)),
        };
        for &(by, role) in &effects.released {
            line.push_str(&format!(", {} lets {} go", self.name(by), self.name(role)));
        }
        line
    }

    /// Describes a face by the name of its block: `A.up`.
    pub fn face_of(&self, state: &ProgramState<'_>, block_face: BlockFace) -> String {
        let face = state.lattice.pose(block_face.body).map(|p| p.orientation);
        let face = face.map_or("", |seat| seat.to_structure(block_face.face).word());
        format!("{}.{face}", self.body(state, block_face.body))
    }

    /// Describes a hop: message, sender and receiver.
    fn hop(&self, state: &ProgramState<'_>, transit: InTransit) -> (String, String, String) {
        let what = self.message(&transit.message);
        (
            what,
            self.body(state, transit.from),
            self.body(state, transit.to),
        )
    }

    fn arrival(&self, before: &ProgramState<'_>, transit: InTransit, effects: &Effects) -> String {
        let what = self.message(&transit.message);
        let at = self.body(before, transit.to);
        if effects.reports > 0 {
            let count = before.structure.reports() + effects.reports;
            return format!("{what} reaches the plate, which has {count} now");
        }
        if effects
            .sent
            .iter()
            .any(|(_, message)| *message == transit.message)
        {
            return format!("{what} passes {at}");
        }
        let block = before.structure.block(transit.to);
        if block.is_some_and(|block| block.is_dead()) {
            return format!("{what} ends at {at}, which has failed");
        }
        if transit.is_taken {
            return format!("{at} drops {what}, a duplicate");
        }
        format!("{what} reaches {at}")
    }

    /// Describes a message: `the report of C`.
    pub fn message(&self, message: &Message) -> String {
        let notification = |notification| self.notification(notification);
        match (message.payload, message.target) {
            (Payload::Report(by), _) => format!("the report of {}", self.name(by.role)),
            (Payload::Ask(role), _) => format!("the release request of {}", self.name(role)),
            (Payload::Notify(what), Recipient::Role(to)) => {
                format!(
                    "the notification for {} that {}",
                    self.name(to),
                    notification(what)
                )
            }
            (Payload::Notify(what), _) => format!("the notification that {}", notification(what)),
        }
    }

    fn notification(&self, notification: Notification) -> String {
        match notification {
            Notification::Anchored(role) => format!("{} is anchored", self.name(role)),
            Notification::Released(role) => format!("{} is released", self.name(role)),
        }
    }

    /// Returns the owner of an open face, the face, and the role of the expected block. Returns
    /// `None` if the face is not open.
    fn face(
        &self,
        state: &ProgramState<'_>,
        block_face: BlockFace,
    ) -> Option<(RoleId, stochc_ir::Face, RoleId)> {
        let block = state.structure.block(block_face.body)?;
        let open = block
            .open()
            .iter()
            .find(|open| open.own == block_face.face)?;
        Some((block.role(), open.face, open.child))
    }

    pub fn fault(&self, fault: Mistake) -> String {
        match fault {
            Mistake::Adrift(role) => {
                format!(
                    "{} is released while it holds another block",
                    self.name(role)
                )
            }
            Mistake::SecondHolder(role) => {
                format!(
                    "{} is captured while another block has its name",
                    self.name(role)
                )
            }
            Mistake::TooEarly(event, missing) => {
                format!(
                    "{} before {}",
                    self.notification(event),
                    self.notification(missing)
                )
            }
            Mistake::OutOfTurn(role) => {
                format!(
                    "{} is captured before enough of its predecessors",
                    self.name(role)
                )
            }
            Mistake::TooManyFaces(role) => {
                format!(
                    "{} magnetizes more faces than its hardware allows",
                    self.name(role)
                )
            }
        }
    }

    /// Describes the missing captures and reports in a state without further transitions.
    pub fn waits(&self, state: &ProgramState<'_>) -> String {
        let mut waits: Vec<String> = Vec::new();
        for block in state.structure.blocks() {
            let body = block.body();
            for open in block.open() {
                let block_face = BlockFace {
                    body,
                    face: open.own,
                };
                let why = match state.lattice.target(block_face) {
                    Some(_) => "which no block can reach",
                    None if state.silent.contains(&block_face) => "whose block does not answer",
                    None => "which is occupied",
                };
                waits.push(format!(
                    "{}.{} waits for {} at {}, {why}",
                    self.name(block.role()),
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

    /// Returns names, separated by commas.
    pub fn names<'r>(&self, roles: impl IntoIterator<Item = &'r RoleId>) -> String {
        let names: Vec<&str> = roles.into_iter().map(|role| self.name(*role)).collect();
        names.join(", ")
    }
}
