//! Neighbours and ancestors of events in a dependency graph.
use petgraph::Direction::{Incoming, Outgoing};
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef as _;
use rustc_hash::FxHashSet;

use crate::dependencies::graph::DependencyGraph;
use crate::expanded::EventId;

/// Returns the events that the event `id` waits for directly.
pub(super) fn before(graph: &DependencyGraph, id: EventId) -> impl Iterator<Item = EventId> {
    (graph.edges_directed(NodeIndex::new(id.0 as usize), Incoming)).map(|edge| graph[edge.source()])
}

/// Returns the events that wait directly for the event `id`.
pub(super) fn after(graph: &DependencyGraph, id: EventId) -> impl Iterator<Item = EventId> {
    (graph.edges_directed(NodeIndex::new(id.0 as usize), Outgoing)).map(|edge| graph[edge.target()])
}

/// Returns these events and all their ancestors.
pub(super) fn all_before(
    graph: &DependencyGraph,
    events: impl IntoIterator<Item = EventId>,
) -> FxHashSet<EventId> {
    let mut open: Vec<EventId> = events.into_iter().collect();
    let mut found: FxHashSet<EventId> = open.iter().copied().collect();
    while let Some(id) = open.pop() {
        open.extend(before(graph, id).filter(|&first| found.insert(first)));
    }
    found
}
