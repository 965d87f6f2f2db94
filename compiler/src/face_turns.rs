//! Faces in turn: where a block magnetizes several at a time, a capture waits for *some* of those before it.
//!
//! An edge of the dependency graph is met when its first event has happened. An event needs all edges into it
//! met, but for its edges from captures of the same block, of which so many are enough ([`LocatedDependency::Face`]). Here
//! such a graph becomes one in which all edges are needed: [`straight`], one way in which everything can happen
//! as early as can be, and [`certain`], what holds in every order.
use std::cmp::Reverse;
use std::collections::BinaryHeap;

use petgraph::Direction::{Incoming, Outgoing};
use petgraph::graph::{EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::graph::{DependencyGraph, LocatedDependency};
use crate::plan::EventId;

/// Whether enough of the edges into an event are met, if those are from events that `has` says have happened.
pub fn is_ready(graph: &DependencyGraph, event: EventId, has: impl Fn(EventId) -> bool) -> bool {
    let (mut met, mut needed) = (0, 0);
    for edge in graph.edges_directed(NodeIndex::new(event.0 as usize), Incoming) {
        let is_met = has(graph[edge.source()]);
        match edge.weight() {
            LocatedDependency::Face {
                needed: so_many, ..
            } => {
                needed = *so_many;
                met += u8::from(is_met);
            }
            _ if !is_met => return false,
            _ => {}
        }
    }
    met >= needed
}

/// Whether some capture has a choice of those it waits for.
pub fn has_choice(graph: &DependencyGraph) -> bool {
    graph.raw_edges().iter().any(|edge| edge.weight.is_choice())
}

/// When every event is over at the earliest, and the event that it waited for last.
#[derive(Clone, Debug, PartialEq)]
pub struct Earliest {
    /// By event, after the start of its phase; infinite: never.
    pub over: Vec<f64>,
    /// By event; `u32::MAX`: it waited for nothing.
    pub last: Vec<u32>,
    /// The events that happen at all, in the order of their ends.
    pub events: Vec<EventId>,
}

/// Brings every event about as early as can be, where each takes so long (0 or more; if it is infinite, all that
/// needs it comes last).
pub fn earliest(graph: &DependencyGraph, length: impl Fn(usize) -> f64) -> Earliest {
    let count = graph.node_count();
    let mut out = Earliest {
        over: vec![f64::INFINITY; count],
        last: vec![u32::MAX; count],
        events: Vec::with_capacity(count),
    };
    // What each event misses: other edges, and edges from captures of the same block.
    let mut missing: Vec<(u32, u32)> = vec![(0, 0); count];
    for edge in graph.raw_edges() {
        let missing = &mut missing[edge.target().index()];
        match edge.weight {
            LocatedDependency::Face { needed, .. } => missing.1 = u32::from(needed),
            _ => missing.0 += 1,
        }
    }
    // Numbers that are not negative are ordered as their bits are.
    let mut open: BinaryHeap<Reverse<(u64, u32)>> = (0..count)
        .filter(|&i| missing[i] == (0, 0))
        .map(|i| Reverse((length(i).to_bits(), i as u32)))
        .collect();
    while let Some(Reverse((over, event))) = open.pop() {
        let over = f64::from_bits(over);
        out.over[event as usize] = over;
        out.events.push(EventId(event));
        for edge in graph.edges_directed(NodeIndex::new(event as usize), Outgoing) {
            let next = edge.target().index();
            let missing = &mut missing[next];
            let left = match edge.weight() {
                LocatedDependency::Face { .. } => &mut missing.1,
                _ => &mut missing.0,
            };
            if *left == 0 {
                continue;
            }
            *left -= 1;
            if *missing == (0, 0) {
                out.last[next] = event;
                open.push(Reverse(((over + length(next)).to_bits(), next as u32)));
            }
        }
    }
    out
}

/// The edges that nothing has to wait for if of each choice those are taken that are over first.
///
/// Of an event that never has enough of them, all are kept.
pub fn unneeded(graph: &DependencyGraph, earliest: &Earliest) -> FxHashSet<EdgeIndex> {
    let mut place = vec![u32::MAX; graph.node_count()];
    for (i, id) in earliest.events.iter().enumerate() {
        place[id.0 as usize] = i as u32;
    }
    let mut choices: FxHashMap<NodeIndex, Vec<(u32, EdgeIndex, u8)>> = FxHashMap::default();
    for edge in graph.edge_references() {
        if let LocatedDependency::Face { needed, of } = *edge.weight()
            && needed < of
        {
            let choice = choices.entry(edge.target()).or_default();
            choice.push((place[edge.source().index()], edge.id(), needed));
        }
    }
    let mut unneeded = FxHashSet::default();
    for mut choice in choices.into_values() {
        choice.sort_unstable();
        let needed = usize::from(choice[0].2);
        if choice[needed - 1].0 < u32::MAX {
            unneeded.extend(choice[needed..].iter().map(|&(_, edge, _)| edge));
        }
    }
    unneeded
}

/// One way in which everything can happen: the graph without the edges that are [`unneeded`].
pub fn straight(graph: &DependencyGraph, unneeded: &FxHashSet<EdgeIndex>) -> DependencyGraph {
    graph.filter_map(
        |_, &id| Some(id),
        |edge, &why| (!unneeded.contains(&edge)).then_some(why),
    )
}

/// What surely comes before what, in every order: the other edges, and for every choice those events
/// that too many of its captures wait for to do without.
///
/// `order` is one in which everything can happen. The search is bounded; beyond that, and where the captures of a choice
/// wait for others that have one, edges may be missing.
pub fn certain(graph: &DependencyGraph, order: &[EventId]) -> DependencyGraph {
    let is_choice = |id: EventId| {
        let mut edges = graph.edges_directed(NodeIndex::new(id.0 as usize), Incoming);
        edges.any(|edge| edge.weight().is_choice())
    };
    let mut certain = graph.filter_map(
        |_, &id| Some(id),
        |_, &why| (!why.is_choice()).then_some(why),
    );
    let mut place = vec![u32::MAX; graph.node_count()];
    for (i, id) in order.iter().enumerate() {
        place[id.0 as usize] = i as u32;
    }
    let mut steps = 1_000_000 + 10 * graph.node_count();
    for &event in order.iter().filter(|&&id| is_choice(id)) {
        let node = NodeIndex::new(event.0 as usize);
        let known: FxHashSet<NodeIndex> = certain.neighbors_directed(node, Incoming).collect();
        // How many of the captures wait for an event, for every event that one of them waits for.
        let mut counts: FxHashMap<NodeIndex, u8> = FxHashMap::default();
        let (mut captures, mut needed) = (0, 0);
        for edge in graph.edges_directed(node, Incoming) {
            let LocatedDependency::Face {
                needed: so_many, ..
            } = *edge.weight()
            else {
                continue;
            };
            needed = so_many;
            let Some(before) = before(&certain, edge.source(), &known, &mut steps) else {
                return certain;
            };
            // One that itself waits for the event is of no use to it.
            if before.contains(&node) {
                continue;
            }
            captures += 1;
            for first in before {
                *counts.entry(first).or_default() += 1;
            }
        }
        let mut sure: Vec<NodeIndex> = (counts.into_iter())
            .filter(|&(_, count)| count + needed > captures)
            .map(|(first, _)| first)
            .collect();
        sure.sort_unstable_by_key(|first| Reverse(place[first.index()]));
        let mut covered: FxHashSet<NodeIndex> = FxHashSet::default();
        for first in sure {
            if covered.contains(&first) {
                continue;
            }
            let Some(before) = before(&certain, first, &known, &mut steps) else {
                return certain;
            };
            covered.extend(before);
            certain.add_edge(first, node, LocatedDependency::Face { needed: 1, of: 1 });
        }
    }
    certain
}

/// An event and all that it surely waits for, but not beyond those that are `known`; `None`: that took too long.
fn before(
    certain: &DependencyGraph,
    event: NodeIndex,
    known: &FxHashSet<NodeIndex>,
    steps: &mut usize,
) -> Option<FxHashSet<NodeIndex>> {
    let mut found = FxHashSet::from_iter([event]);
    let mut open = vec![event];
    while let Some(at) = open.pop() {
        for first in certain.neighbors_directed(at, Incoming) {
            *steps = steps.checked_sub(1)?;
            if !known.contains(&first) && found.insert(first) {
                open.push(first);
            }
        }
    }
    Some(found)
}
