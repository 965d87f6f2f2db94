//! States of a program between its captures.
use rustc_hash::{FxHashMap, FxHashSet};
use stochc_ir::graph::{Dependency, Edge, EventGraph, EventId};
use stochc_ir::table::PhaseId;
use stochc_ir::{Cell, Face};
use thiserror::Error;

use super::events::{Events, PhaseLimit, ProgramParts};
use super::message_times::MessageTimes;
use crate::{Neighbourhood, Rates, Rivals, Wait, rivalry};

/// State of a program between two captures.
#[derive(Clone, Debug, PartialEq)]
pub struct CaptureState {
    /// Number of captures so far, without pre-attached blocks.
    pub captures: usize,
    /// Captures at the open faces.
    pub open: Vec<OpenCapture>,
}

/// Capture at an open face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenCapture {
    /// The capture.
    pub event: EventId,
    /// Number of the face's group. All faces of a group opened at the same time.
    pub group: usize,
    /// Waiting time in the surroundings of this state.
    pub wait: Wait,
    /// Index of the state after the capture.
    pub next: usize,
}

/// Reason why a program has no list of states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NoCaptureStates {
    /// Blocks are released.
    #[error("it releases blocks")]
    Releases,
    /// A phase has a timeout.
    #[error("it has a timeout")]
    Timeout,
    /// A phase has a `wait`.
    #[error("it has a `wait`")]
    Wait,
    /// Messages take time.
    #[error("messages take time in its scene")]
    Messages,
    /// The scene has hardware faults.
    #[error("its scene has faults")]
    Faults,
    /// Bonds can break.
    #[error("bonds can break in its scene")]
    BreakingBonds,
    /// The free blocks do not suffice.
    #[error("it has too few free blocks")]
    FewBlocks,
    /// A cell is unknown, or dependencies have a cycle.
    #[error("its dependency graph is incomplete")]
    Incomplete,
    /// There are too many states.
    #[error("it has more than {0} sets of captured blocks")]
    TooMany(usize),
}

/// Returns the first feature that makes a state depend on more than the captured blocks.
pub fn unsupported_feature(events: &Events<'_>) -> Option<NoCaptureStates> {
    let ProgramParts { graph, scene, .. } = events.parts;
    let limits = events.limits();
    let has_timeout = |limit: &PhaseLimit| limit.timeout.is_finite();
    if graph.events.iter().any(|event| !event.action.is_capture()) {
        Some(NoCaptureStates::Releases)
    } else if limits.iter().any(has_timeout) {
        Some(NoCaptureStates::Timeout)
    } else if limits.iter().any(|limit| limit.wait > 0.0) {
        Some(NoCaptureStates::Wait)
    } else if MessageTimes::new(events).is_some() {
        Some(NoCaptureStates::Messages)
    } else if scene.faults.is_some() {
        Some(NoCaptureStates::Faults)
    } else {
        (scene.has_breaking_bonds()).then_some(NoCaptureStates::BreakingBonds)
    }
}

/// Returns all states that a program can reach in the rate model. The initial state comes first,
/// and each capture leads to a later state.
///
/// # Errors
///
/// If a state depends on more than the captured blocks, or if there are more than `max` states.
pub fn capture_states(
    parts: ProgramParts<'_>,
    rates: &Rates,
    max: usize,
) -> Result<Vec<CaptureState>, NoCaptureStates> {
    let events = Events::new(parts).ok_or(NoCaptureStates::Incomplete)?;
    if let Some(feature) = unsupported_feature(&events) {
        return Err(feature);
    }
    let ProgramParts { graph, scene, .. } = parts;
    let is_early: Vec<bool> = (graph.events.iter())
        .map(|event| events.is_pre_attached(event.phase))
        .collect();
    let early = is_early.iter().filter(|is_early| **is_early).count();
    let count = scene.free.count as usize;
    if graph.events.len() > count {
        return Err(NoCaptureStates::FewBlocks);
    }
    if graph.events.len() - early >= max {
        return Err(NoCaptureStates::TooMany(max));
    }
    let mut found = Found::default();
    let faces = cells_and_faces(graph).ok_or(NoCaptureStates::Incomplete)?;
    let first = found.with_new_faces(graph, is_early, Vec::new());
    found.number(first);
    let mut states = Vec::new();
    while let Some(progress) = found.all.get(states.len()).cloned() {
        let surroundings = Surroundings::new(parts, &progress, &faces);
        let captures = progress.captured.iter().filter(|it| **it).count();
        let free = (count - captures) as f64 / count as f64;
        let open = (progress.open.iter()).map(|&(event, group)| {
            // The first group opens at tick 0.
            let mut wait = surroundings.wait(faces[event.0 as usize], rates, group == 0);
            wait.rate *= rates.parameters.of_free(free);
            let next = found.number_after(graph, &progress, event);
            OpenCapture {
                event,
                group,
                wait,
                next,
            }
        });
        states.push(CaptureState {
            open: open.collect(),
            captures: captures - early,
        });
        if found.all.len() > max {
            return Err(NoCaptureStates::TooMany(max));
        }
    }
    Ok(states)
}

/// Returns the open cell and the direction of the face of each capture.
fn cells_and_faces(graph: &EventGraph) -> Option<Vec<(Cell, Face)>> {
    let events = graph.events.iter();
    events
        .map(|event| event.cell.zip(event.action.face()))
        .collect()
}

/// Captured blocks and open faces. Faces have the number of their group, and are in order.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Progress {
    captured: Vec<bool>,
    open: Vec<(EventId, usize)>,
}

/// All states found so far.
#[derive(Debug, Default)]
struct Found {
    all: Vec<Progress>,
    numbers: FxHashMap<Progress, usize>,
    /// Number of each group, by the faces that open at the same time.
    groups: FxHashMap<Vec<EventId>, usize>,
}

impl Found {
    /// Returns the number of a state. Adds the state if it is new.
    fn number(&mut self, progress: Progress) -> usize {
        let next = self.all.len();
        *self.numbers.entry(progress).or_insert_with_key(|progress| {
            self.all.push(progress.clone());
            next
        })
    }

    /// Returns the number of the state after a capture.
    fn number_after(&mut self, graph: &EventGraph, before: &Progress, capture: EventId) -> usize {
        let Progress { mut captured, open } = before.clone();
        captured[capture.0 as usize] = true;
        let open = open.into_iter().filter(|(event, _)| *event != capture);
        let after = self.with_new_faces(graph, captured, open.collect());
        self.number(after)
    }

    /// Opens all faces that are ready, as a new group.
    fn with_new_faces(
        &mut self,
        graph: &EventGraph,
        captured: Vec<bool>,
        mut open: Vec<(EventId, usize)>,
    ) -> Progress {
        let phase = captured.iter().position(|it| !it);
        let phase = phase.map_or(PhaseId(0), |event| graph.events[event].phase);
        let is_new = |event: &EventId| {
            !captured[event.0 as usize]
                && !open.iter().any(|(it, _)| it == event)
                && is_ready(graph, *event, &captured)
        };
        let new: Vec<EventId> = graph.events_of(phase).filter(is_new).collect();
        if !new.is_empty() {
            let next = self.groups.len();
            let group = *self.groups.entry(new.clone()).or_insert(next);
            open.extend(new.into_iter().map(|event| (event, group)));
            open.sort_unstable();
        }
        Progress { captured, open }
    }
}

/// Returns whether the face of a capture is open as soon as these blocks are captured.
fn is_ready(graph: &EventGraph, event: EventId, captured: &[bool]) -> bool {
    let is_over = |edge: &Edge| captured[edge.first.0 as usize];
    let mut needed = graph.waits_for(event).iter();
    let turns = needed
        .clone()
        .filter(|edge| matches!(edge.why, Dependency::Face { .. }));
    let turns = turns.filter(|edge| is_over(edge)).count();
    needed.all(|edge| match edge.why {
        Dependency::Face { needed, .. } => turns >= usize::from(needed),
        _ => is_over(edge),
    })
}

/// Occupied cells and open faces of a state.
struct Surroundings {
    full: FxHashSet<Cell>,
    open: Vec<(Cell, Face)>,
}

impl Surroundings {
    fn new(parts: ProgramParts<'_>, progress: &Progress, faces: &[(Cell, Face)]) -> Surroundings {
        let seeds = parts.tables.seeds().map(|(_, cell)| cell);
        let captured = faces.iter().zip(&progress.captured);
        let captured = captured.filter_map(|(&(cell, _), is)| is.then_some(cell));
        let open = progress.open.iter();
        Surroundings {
            full: seeds.chain(captured).collect(),
            open: open.map(|(event, _)| faces[event.0 as usize]).collect(),
        }
    }

    /// Returns the waiting time of an open face if all initially free blocks are free.
    fn wait(&self, face: (Cell, Face), rates: &Rates, is_cold: bool) -> Wait {
        let mut rivals = Rivals::default();
        let others = self.open.iter().filter_map(|&other| rivalry(face, other));
        others.for_each(|rivalry| rivals.add(rivalry));
        let (cell, direction) = face;
        let near = Neighbourhood::new(cell, |near| self.full.contains(&near));
        rates.wait_among(cell, direction, near, rivals, is_cold)
    }
}
