//! Blocks with several active faces: a capture waits for *some* of the earlier captures.
//!
//! An event waits for all edges into it in the dependency graph, with one exception. Edges from
//! captures of the same block form a choice: [`LocatedDependency::Face`] states how many of them
//! are needed. This module derives two graphs without choices. [`straight`] lets every event happen
//! as early as possible. `certain` has the edges that hold in every order.
use std::cmp::Reverse;
use std::collections::BinaryHeap;

use petgraph::Direction::{Incoming, Outgoing};
use petgraph::graph::{EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;
use rustc_hash::{FxHashMap, FxHashSet};

use crate::dependencies::graph::{DependencyGraph, LocatedDependency};
use crate::expanded::EventId;

/// Returns whether `event` can happen next. `has` returns whether an event has already happened.
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

/// Returns whether some capture has a choice: it needs only some of the events that it can wait
/// for.
pub fn has_choice(graph: &DependencyGraph) -> bool {
    graph.raw_edges().iter().any(|edge| edge.weight.is_choice())
}

/// Earliest end of every event, and the event that it waited for last.
#[derive(Clone, Debug, PartialEq)]
pub struct Earliest {
    /// Earliest end of each event, measured from the start of its phase. Infinite if the event
    /// never happens.
    pub over: Vec<f64>,
    /// Last event that each event waited for. `u32::MAX` if there was none.
    pub last: Vec<u32>,
    /// Events that happen, sorted by their end.
    pub events: Vec<EventId>,
}

/// Returns the earliest ends of events with the durations `length`, which must not be negative.
/// Events that need an event of infinite duration never end.
pub fn earliest(graph: &DependencyGraph, length: impl Fn(usize) -> f64) -> Earliest {
    let count = graph.node_count();
    let mut out = Earliest {
        over: vec![f64::INFINITY; count],
        last: vec![u32::MAX; count],
        events: Vec::with_capacity(count),
    };
    // Number of missing edges of each event, and of those from captures of the same block.
    let mut missing: Vec<(u32, u32)> = vec![(0, 0); count];
    for edge in graph.raw_edges() {
        let missing = &mut missing[edge.target().index()];
        match edge.weight {
            LocatedDependency::Face { needed, .. } => missing.1 = u32::from(needed),
            _ => missing.0 += 1,
        }
    }
    // The bits of numbers that are not negative sort like the numbers.
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

/// Returns the edges that are not needed if every capture with a choice waits for the earliest
/// events.
///
/// If too few events of a choice ever happen, all its edges are needed.
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

/// Returns the graph without the edges in `unneeded`. All remaining edges count as required.
pub fn straight(graph: &DependencyGraph, unneeded: &FxHashSet<EdgeIndex>) -> DependencyGraph {
    graph.filter_map(
        |_, &id| Some(id),
        |edge, &why| (!unneeded.contains(&edge)).then_some(why),
    )
}

/// Returns the edges that hold in every order. These are the edges without a choice. An edge of a
/// choice is included if all possible selections wait for its event.
///
/// `order` contains all events in a possible order. The search is bounded, so edges may be missing.
/// Edges may also be missing if captures of a choice wait for captures with another choice.
pub(crate) fn certain(graph: &DependencyGraph, order: &[EventId]) -> DependencyGraph {
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
        // Number of captures that wait for each event.
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
            // A capture that itself waits for the event does not help it.
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

/// Returns an event and all events that it waits for in every order, without events in `known`.
/// Counts down `steps`, and returns `None` if they are used up.
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
