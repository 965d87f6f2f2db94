//! The dependency graph: what has to happen before what.
use petgraph::Direction::Incoming;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef as _;
use stochc_grammar::{Cancellation, Cancelled};

use crate::SourceLocation;
use crate::layout::Layout;
use crate::liveness::Liveness;
use crate::plan::{EventId, EventKind, ProgramPlan};

/// Captures and releases, and what each waits for.
///
/// Node `i` is event `i` of the plan. An edge runs from what comes first to what waits. Edges stay
/// within a phase: a phase begins when the one before has ended.
pub type DependencyGraph = DiGraph<EventId, LocatedDependency, u32>;

/// Why an event waits for another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocatedDependency {
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
    /// The program says `after`, there.
    After(SourceLocation),
    /// A block is let go only once its own children are.
    Emptied,
    /// A block can dock only once its cell is empty; the world sees to that by itself.
    Vacated,
    /// A name is given again only once its holder is gone.
    Freed,
}

impl LocatedDependency {
    /// Whether others will do as well.
    pub fn is_choice(self) -> bool {
        stochc_ir::graph::Dependency::from(self).is_choice()
    }

    /// Whether a block that has not seen the other event has to be told of it.
    pub fn is_told(self) -> bool {
        matches!(self, LocatedDependency::After(_) | LocatedDependency::Freed)
    }
}

/// The capture of the same phase that anchors the block that an event is up to; `None`: it is there before.
pub(crate) fn anchored_by(graph: &DependencyGraph, id: EventId) -> Option<EventId> {
    let mut edges = graph.edges_directed(NodeIndex::new(id.0 as usize), Incoming);
    let anchored = edges.find(|edge| *edge.weight() == LocatedDependency::Anchored);
    anchored.map(|edge| graph[edge.source()])
}

/// Builds the graph of a program whose blocks magnetize `faces` faces at a time.
///
/// # Errors
///
/// [`Cancelled`] if nobody waits for it.
pub fn build(
    plan: &ProgramPlan,
    liveness: &Liveness,
    layout: &Layout,
    faces: u8,
    cancellation: Cancellation<'_>,
) -> Result<DependencyGraph, Cancelled> {
    let count = plan.events.len();
    let mut graph = DependencyGraph::with_capacity(count, count + plan.afters.len());
    for id in 0..count as u32 {
        graph.add_node(EventId(id));
    }
    let node = |id: EventId| NodeIndex::new(id.0 as usize);
    let sound = |id: EventId| plan.event(id).sound;
    let mut add = |first: EventId, then: EventId, why: LocatedDependency| {
        if sound(first) && sound(then) {
            graph.add_edge(node(first), node(then), why);
        }
    };
    for id in (0..count as u32).map(EventId) {
        cancellation.check()?;
        let context = liveness.contexts[id.0 as usize];
        if let Some(first) = context.anchored_by {
            add(first, id, LocatedDependency::Anchored);
        }
        if let Some(first) = context.freed_by {
            add(first, id, LocatedDependency::Freed);
        }
    }
    for (first, then, why) in face_turns(plan, faces, cancellation)? {
        add(first, then, why);
    }
    for (after, subject) in plan.afters.iter().zip(&liveness.subjects) {
        if let Some(first) = *subject {
            add(first, after.event, LocatedDependency::After(after.location));
        }
    }
    for &(first, then) in &layout.emptied {
        add(first, then, LocatedDependency::Emptied);
    }
    for &(first, then) in &layout.vacated {
        add(first, then, LocatedDependency::Vacated);
    }
    Ok(graph)
}

/// Captures of one block that wait for those written before them: each until fewer than `faces` of these are
/// still to come.
fn face_turns(
    plan: &ProgramPlan,
    faces: u8,
    cancellation: Cancellation<'_>,
) -> Result<Vec<(EventId, EventId, LocatedDependency)>, Cancelled> {
    let mut turns = Vec::new();
    let faces = faces.max(1);
    // The last capture of each block, with the phase, from 1, and the one before each capture.
    let mut last: Vec<(u32, Option<EventId>)> = vec![(0, None); plan.roles.count()];
    let mut previous: Vec<Option<EventId>> = vec![None; plan.events.len()];
    for (phase, stamp) in plan.phases.iter().zip(1..) {
        for id in plan.events_of(phase) {
            cancellation.check()?;
            let event = plan.event(id);
            let EventKind::Capture { parent, .. } = event.kind else {
                continue;
            };
            if !event.sound {
                continue;
            }
            let slot = &mut last[parent.0 as usize];
            if slot.0 != stamp {
                *slot = (stamp, None);
            }
            previous[id.0 as usize] = slot.1.replace(id);
            // A block has six faces, and each captures once in a phase; what makes no sense may have more.
            let before =
                std::iter::successors(previous[id.0 as usize], |id| previous[id.0 as usize]);
            let before = before.take(6);
            let of = before.clone().count() as u8;
            if of < faces {
                continue;
            }
            let needed = of + 1 - faces;
            if needed == of {
                // The one before has waited for all the others.
                let why = LocatedDependency::Face { needed: 1, of: 1 };
                turns.extend(before.take(1).map(|first| (first, id, why)));
            } else {
                let why = LocatedDependency::Face { needed, of };
                turns.extend(before.map(|first| (first, id, why)));
            }
        }
    }
    Ok(turns)
}
