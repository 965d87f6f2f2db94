//! Dependency graph of a compiled program.
use serde::{Deserialize, Serialize};

use crate::table::{Notification, PhaseId, RoleId, Tables};
use crate::{Cell, Face};

/// Index of a capture or release in [`EventGraph::events`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct EventId(pub u32);

/// Captures and releases, phase by phase in source order, with their dependencies.
///
/// Edges stay within a phase, because a phase begins after the end of the previous one.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventGraph {
    /// Events. Each phase owns a contiguous range.
    pub events: Vec<GraphEvent>,
    /// Critical path of each phase: captures that must follow one another, with the releases
    /// between them. A pre-attached phase has none.
    pub chains: Vec<Vec<EventId>>,
    /// Edges, sorted by the waiting event.
    edges: Vec<Edge>,
}

/// A capture or release, with its phase and cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GraphEvent {
    /// Phase of the event.
    pub phase: PhaseId,
    /// Action of the event.
    #[serde(flatten)]
    pub action: EventAction,
    /// Cell of the block. `None` if the cell is unknown.
    pub cell: Option<Cell>,
    /// Time between the dependencies of the event and its request \[ticks\]. 0 for a capture.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub delay: u32,
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde passes a reference"
)]
fn is_zero(ticks: &u32) -> bool {
    *ticks == 0
}

/// Action of an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", tag = "event")]
pub enum EventAction {
    /// A block magnetizes a face and captures a block in a role.
    Capture {
        /// Role of the capturing block.
        parent: RoleId,
        /// Capturing face, in the structure's frame.
        face: Face,
        /// Role of the captured block.
        child: RoleId,
    },
    /// A block is released.
    Release {
        /// Role of the released block.
        child: RoleId,
    },
}

/// Dependency between two events.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Edge {
    /// The earlier event.
    pub first: EventId,
    /// The waiting event.
    pub then: EventId,
    /// Reason of the dependency.
    pub why: Dependency,
    /// Whether the dependency is not needed in at least one order of events. In such an order,
    /// enough other captures of [`Dependency::Face`] come earlier.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub unneeded: bool,
}

/// Reason why an event waits for another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Dependency {
    /// A block must be anchored before it captures or is released.
    Anchored,
    /// A block magnetizes a limited number of faces at a time, in source order. A capture with `of`
    /// dependencies of this kind waits for any `needed` of them.
    Face {
        /// Required number of satisfied dependencies.
        needed: u8,
        /// Number of dependencies of this kind that the capture has.
        of: u8,
    },
    /// The program states `after`.
    After,
    /// A block can be released only after all its children.
    Emptied,
    /// A cell must be empty before a block is captured there. Physics ensures this, so no message
    /// is needed.
    Vacated,
    /// The capture needs a role that the release frees.
    Freed,
}

impl Dependency {
    /// Returns whether other events can satisfy the same dependency.
    pub fn is_choice(self) -> bool {
        matches!(self, Dependency::Face { needed, of } if needed < of)
    }

    /// Returns the word for this kind of dependency in text and JSON.
    pub fn word(self) -> &'static str {
        match self {
            Dependency::Anchored => "anchored",
            Dependency::Face { .. } => "face",
            Dependency::After => "after",
            Dependency::Emptied => "emptied",
            Dependency::Vacated => "vacated",
            Dependency::Freed => "freed",
        }
    }
}

impl EventAction {
    /// Returns the capturing block of a capture, or the released block of a release.
    pub fn actor(self) -> RoleId {
        match self {
            EventAction::Capture { parent: actor, .. } | EventAction::Release { child: actor } => {
                actor
            }
        }
    }

    /// Returns the face that captures. `None` for a release.
    pub fn face(self) -> Option<Face> {
        match self {
            EventAction::Capture { face, .. } => Some(face),
            EventAction::Release { .. } => None,
        }
    }

    /// Returns the captured or released role.
    pub fn child(self) -> RoleId {
        let (EventAction::Capture { child, .. } | EventAction::Release { child }) = self;
        child
    }

    /// Returns whether the event is a capture.
    pub fn is_capture(self) -> bool {
        matches!(self, EventAction::Capture { .. })
    }

    /// Returns the message content that reports the event.
    pub fn notification(self) -> Notification {
        match self {
            EventAction::Capture { child, .. } => Notification::Anchored(child),
            EventAction::Release { child } => Notification::Released(child),
        }
    }

    /// Describes the action with the names that `name` returns: `A.up -> E`, or `release E`.
    pub fn describe<S: std::fmt::Display>(self, name: impl Fn(RoleId) -> S) -> String {
        match self {
            EventAction::Capture {
                parent,
                face,
                child,
            } => format!("{}.{face} -> {}", name(parent), name(child)),
            EventAction::Release { child } => format!("release {}", name(child)),
        }
    }
}

/// Reason why a graph from a file is invalid.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InvalidGraph {
    /// An event has an unknown phase, or an earlier phase than the previous event.
    #[error("event {0} is in no phase, or out of order")]
    EventPhase(usize),
    /// An event has an unknown role.
    #[error("event {0} is of a block without a name")]
    EventRole(usize),
    /// An edge leads to an unknown event or to another phase.
    #[error("an edge leads to no event of its phase")]
    Edge,
    /// Edges are not sorted.
    #[error("the edges are not sorted")]
    EdgeOrder,
    /// The number of critical paths differs from the number of phases.
    #[error("the chains are not those of the phases")]
    Chains,
}

impl EventGraph {
    /// Builds a graph from edges in any order. Keeps one of several edges with equal ends and
    /// reason.
    pub fn new(
        events: Vec<GraphEvent>,
        mut edges: Vec<Edge>,
        chains: Vec<Vec<EventId>>,
    ) -> EventGraph {
        let key = |edge: &Edge| (edge.then, edge.first, edge.why.word());
        edges.sort_by_key(key);
        edges.dedup_by_key(|edge| key(edge));
        edges.shrink_to_fit();
        EventGraph {
            events,
            chains,
            edges,
        }
    }

    /// Returns an event.
    pub fn event(&self, id: EventId) -> &GraphEvent {
        &self.events[id.0 as usize]
    }

    /// Returns the dependencies of an event, sorted.
    pub fn waits_for(&self, id: EventId) -> &[Edge] {
        let begin = self.edges.partition_point(|edge| edge.then < id);
        let end = self.edges.partition_point(|edge| edge.then <= id);
        &self.edges[begin..end]
    }

    /// Returns all edges, sorted by the waiting event.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// Returns the events of a phase.
    pub fn events_of(&self, phase: PhaseId) -> impl DoubleEndedIterator<Item = EventId> + use<> {
        let begin = self.events.partition_point(|event| event.phase < phase);
        let end = self.events.partition_point(|event| event.phase <= phase);
        (begin as u32..end as u32).map(EventId)
    }

    /// Returns the number of captures in a chain.
    pub fn length(&self, chain: &[EventId]) -> usize {
        let is_capture = |id: &&EventId| self.event(**id).action.is_capture();
        chain.iter().filter(is_capture).count()
    }

    /// Returns the number of blocks of the largest structure at the end of a phase.
    pub fn largest_structure(&self) -> u32 {
        let (mut blocks, mut largest) = (0_i64, 0);
        for of_phase in self.events.chunk_by(|one, other| one.phase == other.phase) {
            let captures = of_phase.iter().filter(|it| it.action.is_capture()).count();
            blocks += 2 * captures as i64 - of_phase.len() as i64;
            largest = largest.max(blocks);
        }
        largest as u32
    }

    /// Describes an event.
    pub fn describe(&self, id: EventId, tables: &Tables) -> String {
        self.event(id).action.describe(|role| tables.name(role))
    }

    /// Validates a graph from a file against the tables.
    ///
    /// # Errors
    ///
    /// If an index is invalid, events are out of order, or an edge leads back or into another
    /// phase.
    pub fn validate(&self, tables: &Tables) -> Result<(), InvalidGraph> {
        let (phases, roles) = (tables.phases.len(), tables.roles.len());
        let known = |role: RoleId| (role.0 as usize) < roles;
        let mut last = PhaseId(0);
        for (number, event) in self.events.iter().enumerate() {
            let parent = match event.action {
                EventAction::Capture { parent, .. } => parent,
                EventAction::Release { child } => child,
            };
            if event.phase.0 as usize >= phases || event.phase < last {
                return Err(InvalidGraph::EventPhase(number));
            }
            if !known(parent) || !known(event.action.child()) {
                return Err(InvalidGraph::EventRole(number));
            }
            last = event.phase;
        }
        let exists = |id: EventId| (id.0 as usize) < self.events.len();
        let phase = |id: EventId| self.event(id).phase;
        for edge in &self.edges {
            if !exists(edge.first) || !exists(edge.then) || phase(edge.first) != phase(edge.then) {
                return Err(InvalidGraph::Edge);
            }
        }
        if !self.edges.is_sorted_by_key(|edge| edge.then) {
            return Err(InvalidGraph::EdgeOrder);
        }
        if self.chains.len() != phases || !self.chains.iter().flatten().all(|&id| exists(id)) {
            return Err(InvalidGraph::Chains);
        }
        Ok(())
    }
}
