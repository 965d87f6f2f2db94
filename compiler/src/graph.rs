//! The dependency graph: what has to happen before what.
use petgraph::graph::{DiGraph, NodeIndex};

use crate::Site;
use crate::layout::Layout;
use crate::plan::{Deed, EventId, Plan};
use crate::presence::Presence;

/// Captures and releases, and what each waits for.
///
/// Node `i` is event `i` of the plan. An edge runs from what comes first to what waits. Edges stay
/// within a phase: a phase begins when the one before has ended.
pub type DependencyGraph = DiGraph<EventId, Dependency, u32>;

/// Why an event waits for another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dependency {
    /// A block captures, or is released, only once it is anchored.
    Anchored,
    /// A block magnetizes so many faces at a time; the next one waits in source order.
    Face,
    /// The program says `after`, there.
    After(Site),
    /// A block is let go only once its own children are.
    Emptied,
    /// A block can dock only once its cell is empty; the world sees to that by itself.
    Vacated,
    /// A name is given again only once its holder is gone.
    Freed,
}

impl Dependency {
    /// The reason, as text forms show it.
    pub fn word(self) -> &'static str {
        match self {
            Dependency::Anchored => "anchored",
            Dependency::Face => "face",
            Dependency::After(_) => "after",
            Dependency::Emptied => "emptied",
            Dependency::Vacated => "vacated",
            Dependency::Freed => "freed",
        }
    }
}

/// Builds the graph of a program whose blocks magnetize `faces` faces at a time.
pub fn build(plan: &Plan, presence: &Presence, layout: &Layout, faces: u8) -> DependencyGraph {
    let count = plan.events.len();
    let mut graph = DependencyGraph::with_capacity(count, count + plan.afters.len());
    for id in 0..count as u32 {
        graph.add_node(EventId(id));
    }
    let node = |id: EventId| NodeIndex::new(id.0 as usize);
    let sound = |id: EventId| plan.event(id).sound;
    let mut add = |first: EventId, then: EventId, why: Dependency| {
        if sound(first) && sound(then) {
            graph.add_edge(node(first), node(then), why);
        }
    };
    for id in (0..count as u32).map(EventId) {
        let context = presence.contexts[id.0 as usize];
        if let Some(first) = context.anchored_by {
            add(first, id, Dependency::Anchored);
        }
        if let Some(first) = context.freed_by {
            add(first, id, Dependency::Freed);
        }
    }
    for (first, then) in face_turns(plan, faces) {
        add(first, then, Dependency::Face);
    }
    for (after, subject) in plan.afters.iter().zip(&presence.subjects) {
        if let Some(first) = *subject {
            add(first, after.event, Dependency::After(after.site));
        }
    }
    for &(first, then) in &layout.emptied {
        add(first, then, Dependency::Emptied);
    }
    for &(first, then) in &layout.vacated {
        add(first, then, Dependency::Vacated);
    }
    graph
}

/// Captures of one block that wait for each other: the one `faces` places before in source order.
fn face_turns(plan: &Plan, faces: u8) -> Vec<(EventId, EventId)> {
    let mut turns = Vec::new();
    // The last captures of each block, in rings of `faces`, forgotten at the end of a phase.
    let faces = usize::from(faces.max(1));
    let mut last: Vec<(u32, u32)> = vec![(0, 0); plan.roles.count()];
    let mut rings: Vec<EventId> = Vec::new();
    for (number, phase) in plan.phases.iter().enumerate() {
        let stamp = number as u32 + 1;
        rings.clear();
        let mut heads: rustc_hash::FxHashMap<u32, usize> = rustc_hash::FxHashMap::default();
        for id in plan.events_of(phase) {
            let event = plan.event(id);
            let Deed::Capture { parent, .. } = event.deed else {
                continue;
            };
            if !event.sound {
                continue;
            }
            let slot = &mut last[parent.0 as usize];
            if slot.0 != stamp {
                *slot = (stamp, 0);
            }
            let turn = slot.1 as usize;
            slot.1 += 1;
            if faces == 1 {
                // One face at a time: the ring is the last capture alone.
                let head = heads.entry(parent.0).or_insert_with(|| {
                    rings.push(id);
                    rings.len() - 1
                });
                if turn > 0 {
                    turns.push((rings[*head], id));
                    rings[*head] = id;
                }
                continue;
            }
            let head = *heads.entry(parent.0).or_insert_with(|| {
                let head = rings.len();
                rings.extend(std::iter::repeat_n(id, faces));
                head
            });
            let place = head + turn % faces;
            if turn >= faces {
                turns.push((rings[place], id));
            }
            rings[place] = id;
        }
    }
    turns
}
