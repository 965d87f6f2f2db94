//! Events of a program, their dependencies and the parents of their blocks.
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use stochc_ir::graph::{Dependency, EventGraph, EventId};
use stochc_ir::scene::Scene;
use stochc_ir::table::{PhaseId, RoleId, Tables};
use stochc_ir::{Cell, Face, JamRisk};

use super::PhaseCost;

/// A program to estimate: the parts of its executable.
#[derive(Clone, Copy, Debug)]
pub struct ProgramParts<'a> {
    /// Event tables of the program.
    pub tables: &'a Tables,
    /// Dependency graph of the program.
    pub graph: &'a EventGraph,
    /// Scene of the program.
    pub scene: &'a Scene,
    /// Reasons why blocks may jam.
    pub jam_risks: &'a [JamRisk],
}

/// A block, identified by the capture that anchored it. `None` for the plate.
pub type Block = Option<EventId>;

/// A block with one of its roles. The plate has a role for each seed.
pub type NamedBlock = (RoleId, Block);

/// Time limit of a phase.
#[derive(Clone, Copy, Debug)]
pub struct PhaseLimit {
    /// Timeout \[ticks\]. Infinite without a timeout.
    pub timeout: f64,
    /// Number of times that the phase begins again after its timeout.
    pub retries: u32,
    /// Time between a timeout and the next attempt \[ticks\].
    pub pause: f64,
    /// Shortest duration of an attempt \[ticks\].
    pub wait: f64,
}

impl PhaseLimit {
    /// Returns the same limit without the timeout.
    pub fn without_timeout(self) -> PhaseLimit {
        PhaseLimit {
            timeout: f64::INFINITY,
            retries: 0,
            ..self
        }
    }
}

pub struct Events<'a> {
    pub parts: ProgramParts<'a>,
    /// All events in topological order.
    pub(super) order: Vec<EventId>,
    /// For each event, the number of captures on the longest chain of events that ends with this
    /// event. The chain stays within one phase.
    levels: Vec<u32>,
    /// For each capture, the capturing block. For each release, the released block.
    pub actors: Vec<NamedBlock>,
}

impl<'a> Events<'a> {
    /// Sorts the events of a program. Returns `None` if its graph has a cycle.
    pub fn new(parts: ProgramParts<'a>) -> Option<Events<'a>> {
        let graph = parts.graph;
        let count = graph.events.len();
        let mut missing = vec![0_u32; count];
        let mut followers = vec![Vec::new(); count];
        for edge in graph.edges().iter().filter(|edge| !edge.unneeded) {
            missing[edge.then.0 as usize] += 1;
            followers[edge.first.0 as usize].push(edge.then);
        }
        let all = (0..count as u32).map(EventId);
        let mut order: Vec<EventId> = all.filter(|id| missing[id.0 as usize] == 0).collect();
        let mut levels = vec![0; count];
        let mut next = 0;
        while let Some(&id) = order.get(next) {
            next += 1;
            levels[id.0 as usize] += u32::from(graph.event(id).action.is_capture());
            for follower in &followers[id.0 as usize] {
                let at = follower.0 as usize;
                levels[at] = levels[at].max(levels[id.0 as usize]);
                missing[at] -= 1;
                if missing[at] == 0 {
                    order.push(*follower);
                }
            }
        }
        (order.len() == count).then(|| Events {
            parts,
            order,
            levels,
            actors: actors(parts),
        })
    }

    pub fn phases(&self) -> impl ExactSizeIterator<Item = PhaseId> + use<> {
        (0..self.parts.tables.phases.len()).map(|number| PhaseId(number as u32))
    }

    pub fn is_pre_attached(&self, phase: PhaseId) -> bool {
        self.parts.tables.phases[phase.0 as usize].pre_attached
    }

    pub fn is_capture(&self, id: EventId) -> bool {
        self.parts.graph.event(id).action.is_capture()
    }

    /// Returns whether each event depends on a release that happens only after a time.
    pub fn delayed(&self) -> Vec<bool> {
        let graph = self.parts.graph;
        let mut predecessors = vec![SmallVec::<[EventId; 2]>::new(); graph.events.len()];
        for edge in graph.edges().iter().filter(|edge| !edge.unneeded) {
            predecessors[edge.then.0 as usize].push(edge.first);
        }
        let mut delayed = vec![false; graph.events.len()];
        for id in &self.order {
            let number = id.0 as usize;
            let is_late = |first: &EventId| delayed[first.0 as usize];
            delayed[number] =
                graph.event(*id).delay > 0 || predecessors[number].iter().any(is_late);
        }
        delayed
    }

    /// Returns the time limit of each phase.
    pub fn limits(&self) -> Vec<PhaseLimit> {
        let phases = self.parts.tables.phases.iter();
        let limits = phases.map(|phase| PhaseLimit {
            timeout: phase.timeout.map_or(f64::INFINITY, |ticks| ticks as f64),
            retries: phase.recovery.map_or(0, |recovery| recovery.retries),
            wait: phase.wait as f64,
            pause: phase.recovery.map_or(0.0, |recovery| recovery.pause as f64),
        });
        limits.collect()
    }

    /// Returns the depth and the width of each phase.
    pub fn shapes(&self) -> Vec<PhaseCost> {
        let shape = |phase| {
            let mut counts = vec![0; 1];
            if !self.is_pre_attached(phase) {
                for id in self
                    .parts
                    .graph
                    .events_of(phase)
                    .filter(|id| self.is_capture(*id))
                {
                    let level = self.levels[id.0 as usize] as usize;
                    counts.resize(counts.len().max(level + 1), 0);
                    counts[level] += 1;
                }
            }
            PhaseCost {
                timed_out: 0.0,
                wait: 0.0,
                depth: counts.len() as u32 - 1,
                width: counts.iter().copied().max().unwrap_or(0),
                times: None,
            }
        };
        self.phases().map(shape).collect()
    }

    /// Returns the events of a phase in source order.
    pub fn of_phase(&self, phase: PhaseId) -> Vec<PhaseEvent> {
        let graph = self.parts.graph;
        let level_in_phase = |capture: EventId| {
            if graph.event(capture).phase == phase {
                self.levels[capture.0 as usize]
            } else {
                0
            }
        };
        let events = graph.events_of(phase).filter_map(|id| {
            let event = graph.event(id);
            let block = self.actors[id.0 as usize].1;
            Some(PhaseEvent {
                id,
                cell: event.cell?,
                level: self.levels[id.0 as usize],
                face: event.action.face(),
                releases_since: block
                    .filter(|_| !event.action.is_capture())
                    .map(level_in_phase),
            })
        });
        events.collect()
    }
}

fn actors(ProgramParts { tables, graph, .. }: ProgramParts<'_>) -> Vec<NamedBlock> {
    let mut holders: FxHashMap<RoleId, EventId> = FxHashMap::default();
    let mut actors = Vec::with_capacity(graph.events.len());
    for phase in (0..tables.phases.len() as u32).map(PhaseId) {
        for id in graph.events_of(phase) {
            let actor = graph.event(id).action.actor();
            let mut waits_for = graph.waits_for(id).iter();
            let anchored_by = waits_for.find(|edge| edge.why == Dependency::Anchored);
            let before = || holders.get(&actor).copied();
            actors.push((actor, anchored_by.map(|edge| edge.first).or_else(before)));
        }
        let captures = graph.events_of(phase);
        for id in captures.filter(|id| graph.event(*id).action.is_capture()) {
            holders.insert(graph.event(id).action.child(), id);
        }
    }
    actors
}

/// An event with a known cell.
#[derive(Clone, Copy, Debug)]
pub struct PhaseEvent {
    pub id: EventId,
    /// Cell that the event fills or empties.
    pub cell: Cell,
    /// Level of the event: the number of captures on the longest chain of events that ends with
    /// this event. The chain stays within one phase.
    pub level: u32,
    /// Capturing face. `None` for a release.
    pub face: Option<Face>,
    /// Level of the capture that anchored the released block in this phase. 0 if the block was
    /// attached before the phase. `None` for a capture.
    pub releases_since: Option<u32>,
}

impl PhaseEvent {
    pub fn is_release(&self) -> bool {
        self.face.is_none()
    }

    /// Returns the decrease of the number of free blocks: 1 for a capture, -1 for a release.
    pub fn taken(&self) -> i64 {
        taken(!self.is_release())
    }
}

/// Returns the decrease of the number of free blocks: 1 for a capture, -1 for a release.
pub fn taken(is_capture: bool) -> i64 {
    if is_capture { 1 } else { -1 }
}

/// Returns the number of bound blocks when the captures of each level begin, and at the end of the
/// phase. `before` is the number of bound blocks when the phase begins.
pub fn bound(before: i64, events: &[PhaseEvent]) -> Vec<i64> {
    let levels = events.iter().map(|event| event.level).max();
    let mut bound = vec![0; levels.map_or(1, |levels| levels as usize + 2)];
    bound[0] = before;
    for event in events {
        bound[event.level as usize + 1] += event.taken();
    }
    let mut sum = 0;
    for bound in &mut bound {
        sum += *bound;
        *bound = sum;
    }
    bound
}
