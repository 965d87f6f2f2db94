//! Program of a log: its names, its events and its start.
use std::collections::HashMap;
use std::ops::ControlFlow;

use stochc_ir::Face;
use stochc_ir::graph::{Dependency, EventAction, EventGraph, EventId};
use stochc_ir::record::{Outcome, RunRecord};
use stochc_ir::table::{PhaseId, RoleId, Tables};
use stochc_runtime::{Model, Settings, run};
use stochc_text::suggest::nearest;

use super::error::{LogError, RowError};
use crate::EnsembleProgram;
use crate::records::ProgramEvents;

/// Program of a log.
pub(super) struct LoggedProgram<'p> {
    pub tables: &'p Tables,
    pub graph: &'p EventGraph,
    /// Number of free blocks of the scene.
    pub blocks: u32,
    events: ProgramEvents<'p>,
    roles: HashMap<&'p str, RoleId>,
    /// Record of a run that has just started, with the pre-attached blocks.
    pub start: RunRecord,
}

impl<'p> LoggedProgram<'p> {
    pub fn new(program: &'p EnsembleProgram) -> Result<LoggedProgram<'p>, LogError> {
        let tables = program.tables();
        if tables.aggregate.is_some() {
            return Err(LogError::Aggregate(program.name.clone()));
        }
        if tables.phases.iter().all(|phase| phase.pre_attached) {
            return Err(LogError::NoPhase(program.name.clone()));
        }
        let settings = Settings {
            max_ticks: Some(0),
            ..Settings::new(Model::Shuffle, 1)
        };
        let failure = |reason: String| LogError::Program(program.name.clone(), reason);
        let mut watch = |_, _| ControlFlow::Continue(());
        let start = run(tables, &program.scene, &settings, 0, 0, &mut watch);
        let start = start.map_err(|error| failure(error.to_string()))?;
        if let Outcome::Failed { reason, .. } = start.outcome {
            return Err(failure(reason));
        }
        let roles = (0..).map(RoleId).zip(&tables.roles);
        Ok(LoggedProgram {
            tables,
            graph: &program.compiled.graph,
            blocks: program.scene.free.count,
            events: ProgramEvents::new(program),
            roles: roles.map(|(id, role)| (role.name.as_str(), id)).collect(),
            start,
        })
    }

    /// Returns the role of a name. A number is the number of the role in firmware.
    pub fn role(&self, name: &str) -> Result<RoleId, RowError> {
        let number = name.parse().ok().map(RoleId);
        let number = number.filter(|it| (it.0 as usize) < self.tables.roles.len());
        let role = self.roles.get(name).copied().or(number);
        role.ok_or_else(|| {
            let names = self.tables.roles.iter().map(|role| role.name.as_str());
            RowError::Block {
                name: name.to_owned(),
                near: nearest(name, names).map(|near| near.word),
            }
        })
    }

    /// Returns the block and the face of a text such as `A.up`. A number is the number of the face in
    /// firmware.
    pub fn face(&self, text: &str) -> Result<(RoleId, Face), RowError> {
        let numbered = |text: &str| Face::ALL.get(text.parse::<usize>().ok()?).copied();
        let face = |text| Face::from_word(text).or_else(|| numbered(text));
        let parts = text.rsplit_once('.');
        let parts = parts.and_then(|(block, text)| Some((block, face(text)?)));
        let (block, face) = parts.ok_or_else(|| RowError::Face(text.to_owned()))?;
        Ok((self.role(block)?, face))
    }

    /// Returns the name of a phase. A number is the number of the phase in firmware.
    pub fn phase_name<'t>(&'t self, text: &'t str) -> Result<&'t str, RowError> {
        let phases = self.tables.phases.iter().filter(|it| !it.pre_attached);
        let names = phases.map(|phase| phase.name.as_str());
        if text.is_empty() {
            return Err(RowError::Missing("block"));
        }
        let number = text.parse().ok();
        let numbered = number.and_then(|number: usize| self.tables.phases.get(number));
        let name = numbered.map_or(text, |phase| &phase.name);
        if names.clone().any(|it| it == name) {
            return Ok(name);
        }
        Err(RowError::NoPhase {
            name: text.to_owned(),
            near: nearest(text, names).map(|near| near.word),
        })
    }

    pub fn phase(&self, phase: PhaseId) -> &str {
        &self.tables.phases[phase.0 as usize].name
    }

    pub fn describe(&self, action: EventAction) -> String {
        action.describe(|role| self.tables.name(role))
    }

    /// Returns the events with an action in a phase, in source order.
    pub fn events(&self, phase: PhaseId, action: EventAction) -> impl Iterator<Item = EventId> {
        self.events.of(phase, action)
    }

    /// Returns the phases that contain an action.
    pub fn phases_with(&self, action: EventAction) -> impl Iterator<Item = PhaseId> {
        let phases = (0..self.tables.phases.len() as u32).map(PhaseId);
        phases.filter(move |&phase| self.events(phase, action).next().is_some())
    }

    /// Returns an event of the same block as `action`, which the program does not have. Prefers
    /// events in `phase`.
    pub fn alternative(&self, phase: PhaseId, action: EventAction) -> Option<String> {
        let is_similar = |other: &EventAction| {
            other.child() == action.child() && other.is_capture() == action.is_capture()
        };
        let of_phase = self.graph.events_of(phase).map(|id| self.graph.event(id));
        let mut all = of_phase.chain(&self.graph.events).map(|event| event.action);
        all.find(is_similar).map(|it| self.describe(it))
    }

    /// Returns the earliest possible tick of an event, or an event that it waits for. `done`
    /// returns the tick of an event. A face may open before its cell is empty, so `Vacated` counts
    /// only if `is_docking` is set.
    pub fn ready(
        &self,
        id: EventId,
        is_docking: bool,
        done: impl Fn(EventId) -> Option<u64>,
    ) -> Result<u64, EventId> {
        let mut ready = 0;
        let mut choices = Vec::new();
        let mut missing = None;
        let mut needs = 0;
        for edge in self.graph.waits_for(id) {
            match edge.why {
                Dependency::Face { needed, of } if needed < of => {
                    needs = usize::from(needed);
                    missing = missing.or(Some(edge.first));
                    choices.extend(done(edge.first));
                }
                Dependency::Vacated if !is_docking => {}
                _ if edge.unneeded => {}
                _ => ready = ready.max(done(edge.first).ok_or(edge.first)?),
            }
        }
        choices.sort_unstable();
        match (needs, choices.get(needs.saturating_sub(1)), missing) {
            (0, ..) => Ok(ready),
            (_, Some(&choice), _) => Ok(ready.max(choice)),
            (_, None, missing) => Err(missing.unwrap_or(id)),
        }
    }
}
