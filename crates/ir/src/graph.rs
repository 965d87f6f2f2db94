//! The dependency graph of a compiled program: what has to happen before what.
use serde::{Deserialize, Serialize};

use crate::table::{News, PhaseId, RoleId, Tables};
use crate::{Cell, Face};

/// A capture or a release; an index into [`EventGraph::events`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct EventId(pub u32);

/// Captures and releases, phase by phase in source order, and what each waits for.
///
/// Edges stay within a phase: a phase begins when the one before has ended.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct EventGraph {
    /// The events; those of a phase are a contiguous range.
    pub events: Vec<GraphEvent>,
    /// The longest serial chain of each phase: captures that have to follow one another, with the releases between
    /// them. A planted phase has none.
    pub chains: Vec<Vec<EventId>>,
    /// Sorted by the event that waits.
    edges: Vec<Edge>,
}

/// A capture or a release.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GraphEvent {
    /// In which phase.
    pub phase: PhaseId,
    /// What happens.
    #[serde(flatten)]
    pub action: EventAction,
    /// Where the block sits.
    pub cell: Option<Cell>,
}

/// What happens in an event.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", tag = "event")]
pub enum EventAction {
    /// A block magnetizes a face and gives what docks there a role.
    Capture {
        /// The block that does.
        parent: RoleId,
        /// Through this face, in the structure's frame.
        face: Face,
        /// The role that is given.
        child: RoleId,
    },
    /// A block is let go.
    Release {
        /// The role that ends.
        child: RoleId,
    },
}

/// An event waits for another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Edge {
    /// What comes first.
    pub first: EventId,
    /// What waits.
    pub then: EventId,
    /// Why.
    pub why: Dependency,
    /// Whether there is an order that does without, because a capture of the same block comes sooner.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub unneeded: bool,
}

/// Why an event waits for another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Dependency {
    /// A block captures, or is released, only once it is anchored.
    Anchored,
    /// A block magnetizes so many faces at a time, in source order: of the `of` edges of this kind that lead to a capture,
    /// `needed` are enough.
    Face {
        /// Captures of the block that have to have docked.
        needed: u8,
        /// Those that count.
        of: u8,
    },
    /// The program says `after`.
    After,
    /// A block is let go only once its own children are.
    Emptied,
    /// A block can dock only once its cell is empty; the world sees to that by itself.
    Vacated,
    /// A name is given again only once its holder is gone.
    Freed,
}

impl Dependency {
    /// Whether others will do as well.
    pub fn is_choice(self) -> bool {
        matches!(self, Dependency::Face { needed, of } if needed < of)
    }

    /// The reason, as text forms show it.
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
    /// The role that begins or ends.
    pub fn child(self) -> RoleId {
        let (EventAction::Capture { child, .. } | EventAction::Release { child }) = self;
        child
    }

    /// Whether it is a capture.
    pub fn is_capture(self) -> bool {
        matches!(self, EventAction::Capture { .. })
    }

    /// What messages call it.
    pub fn news(self) -> News {
        match self {
            EventAction::Capture { child, .. } => News::Anchored(child),
            EventAction::Release { child } => News::Released(child),
        }
    }

    /// In a few words, with the names that `name` gives: `A.up -> E`, or `release E`.
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

impl EventGraph {
    /// Puts a graph together; the edges may come in any order, and of two with the same ends and reason one stays.
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

    /// An event.
    pub fn event(&self, id: EventId) -> &GraphEvent {
        &self.events[id.0 as usize]
    }

    /// What an event waits for, sorted.
    pub fn waits_for(&self, id: EventId) -> &[Edge] {
        let begin = self.edges.partition_point(|edge| edge.then < id);
        let end = self.edges.partition_point(|edge| edge.then <= id);
        &self.edges[begin..end]
    }

    /// Every edge, sorted by the event that waits.
    pub fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// The events of a phase.
    pub fn events_of(&self, phase: PhaseId) -> impl DoubleEndedIterator<Item = EventId> + use<> {
        let begin = self.events.partition_point(|event| event.phase < phase);
        let end = self.events.partition_point(|event| event.phase <= phase);
        (begin as u32..end as u32).map(EventId)
    }

    /// Captures in a chain.
    pub fn length(&self, chain: &[EventId]) -> usize {
        let is_capture = |id: &&EventId| self.event(**id).action.is_capture();
        chain.iter().filter(is_capture).count()
    }

    /// Returns the number of blocks of the largest structure that a phase ends with.
    pub fn largest_structure(&self) -> u32 {
        let (mut blocks, mut largest) = (0_i64, 0);
        for of_phase in self.events.chunk_by(|one, other| one.phase == other.phase) {
            let captures = of_phase.iter().filter(|it| it.action.is_capture()).count();
            blocks += 2 * captures as i64 - of_phase.len() as i64;
            largest = largest.max(blocks);
        }
        largest as u32
    }

    /// An event in a few words.
    pub fn describe(&self, id: EventId, tables: &Tables) -> String {
        self.event(id).action.describe(|role| tables.name(role))
    }

    /// What keeps it from being the graph of these tables, in words: for a graph that was read from a file.
    ///
    /// # Errors
    /// When a number stands for nothing, events are out of order, or an edge leads back or into another phase.
    pub fn validate(&self, tables: &Tables) -> Result<(), String> {
        let (phases, roles) = (tables.phases.len(), tables.roles.len());
        let known = |role: RoleId| (role.0 as usize) < roles;
        let mut last = PhaseId(0);
        for (number, event) in self.events.iter().enumerate() {
            let parent = match event.action {
                EventAction::Capture { parent, .. } => parent,
                EventAction::Release { child } => child,
            };
            if event.phase.0 as usize >= phases || event.phase < last {
                return Err(format!("event {number} is in no phase, or out of order"));
            }
            if !known(parent) || !known(event.action.child()) {
                return Err(format!("event {number} is of a block without a name"));
            }
            last = event.phase;
        }
        let exists = |id: EventId| (id.0 as usize) < self.events.len();
        let phase = |id: EventId| self.event(id).phase;
        for edge in &self.edges {
            if !exists(edge.first) || !exists(edge.then) || phase(edge.first) != phase(edge.then) {
                return Err("an edge leads to no event of its phase".to_owned());
            }
        }
        if !self.edges.is_sorted_by_key(|edge| edge.then) {
            return Err("the edges are not sorted".to_owned());
        }
        if self.chains.len() != phases || !self.chains.iter().flatten().all(|&id| exists(id)) {
            return Err("the chains are not those of the phases".to_owned());
        }
        Ok(())
    }
}
