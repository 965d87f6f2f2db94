//! Dependencies between the events of a program.
use petgraph::Direction::Incoming;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef as _;
use stochc_grammar::{Cancellation, Cancelled};

use crate::SourceLocation;
use crate::blocks::liveness::Liveness;
use crate::expanded::{EventId, EventKind, ExpandedProgram};
use crate::shapes::layout::Layout;

/// Events and their dependencies.
///
/// Node `i` is event `i` of the plan. An edge goes from the earlier event to the waiting one. Edges
/// stay within a phase, because a phase starts after the end of the previous one.
pub type DependencyGraph = DiGraph<EventId, LocatedDependency, u32>;

/// Reason why an event waits for another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocatedDependency {
    /// The event needs an attached block, which the capture attaches.
    Anchored,
    /// A block can switch on a limited number of faces at a time, in source order. A capture has
    /// `of` edges of this kind, and `needed` of them are enough.
    Face {
        /// Required number of earlier captures by the block.
        needed: u8,
        /// Total number of edges of this kind into the capture.
        of: u8,
    },
    /// The program states an `after` at this location.
    After(SourceLocation),
    /// The release of a parent waits for the releases of its children.
    Emptied,
    /// The capture needs a cell that the release empties. Physics ensures this order.
    Vacated,
    /// The capture needs a name that the release frees.
    Freed,
}

impl LocatedDependency {
    /// Returns whether other events can satisfy the same dependency.
    pub fn is_choice(self) -> bool {
        stochc_ir::graph::Dependency::from(self).is_choice()
    }

    /// Returns whether the waiting block needs a message, because it cannot observe the earlier
    /// event.
    pub fn needs_message(self) -> bool {
        matches!(self, LocatedDependency::After(_) | LocatedDependency::Freed)
    }
}

/// Returns the capture of the same phase that attaches the acting block. Returns `None` if it is
/// attached before.
pub(crate) fn anchored_by(graph: &DependencyGraph, id: EventId) -> Option<EventId> {
    let mut edges = graph.edges_directed(NodeIndex::new(id.0 as usize), Incoming);
    let anchored = edges.find(|edge| *edge.weight() == LocatedDependency::Anchored);
    anchored.map(|edge| graph[edge.source()])
}

/// Builds the graph of a program whose blocks can switch on `faces` faces at a time.
///
/// # Errors
///
/// Returns [`Cancelled`] if the check was cancelled.
pub fn build(
    plan: &ExpandedProgram,
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
    let valid = |id: EventId| plan.event(id).valid;
    let mut add = |first: EventId, then: EventId, why: LocatedDependency| {
        if valid(first) && valid(then) {
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

/// Returns the dependencies of captures that wait for a free face. Such a capture waits until fewer
/// than `faces` earlier captures by the same block are pending.
fn face_turns(
    plan: &ExpandedProgram,
    faces: u8,
    cancellation: Cancellation<'_>,
) -> Result<Vec<(EventId, EventId, LocatedDependency)>, Cancelled> {
    let mut turns = Vec::new();
    let faces = faces.max(1);
    // Last capture of each block with its phase, from 1, and the capture before each capture.
    let mut last: Vec<(u32, Option<EventId>)> = vec![(0, None); plan.roles.count()];
    let mut previous: Vec<Option<EventId>> = vec![None; plan.events.len()];
    for (phase, stamp) in plan.phases.iter().zip(1..) {
        for id in plan.events_of(phase) {
            cancellation.check()?;
            let event = plan.event(id);
            let EventKind::Capture { parent, .. } = event.kind else {
                continue;
            };
            if !event.valid {
                continue;
            }
            let slot = &mut last[parent.0 as usize];
            if slot.0 != stamp {
                *slot = (stamp, None);
            }
            previous[id.0 as usize] = slot.1.replace(id);
            // A block has six faces, and each captures once per phase. Invalid programs may have
            // more.
            let before =
                std::iter::successors(previous[id.0 as usize], |id| previous[id.0 as usize]);
            let before = before.take(6);
            let of = before.clone().count() as u8;
            if of < faces {
                continue;
            }
            let needed = of + 1 - faces;
            if needed == of {
                // The previous capture has waited for all earlier ones.
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
