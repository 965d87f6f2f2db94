//! Cycles and critical paths.
use std::cmp::Ordering;

use petgraph::Direction::{self, Incoming, Outgoing};
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{EdgeIndex, EdgeReference, NodeIndex};
use petgraph::visit::EdgeRef;
use rustc_hash::{FxHashMap, FxHashSet};
use stochc_grammar::{Cancellation, Cancelled, Symbols};

use crate::Sources;
use crate::dependencies::face_turns;
use crate::dependencies::graph::{DependencyGraph, LocatedDependency};
use crate::diagnostic::{Code, Diagnostic, Fix, entry};
use crate::expanded::{EventId, EventKind, ExpandedProgram};

/// A possible order of all events, and the longest chains.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Order {
    /// Valid events in topological order.
    pub events: Vec<EventId>,
    /// Critical path of each phase: captures that must follow one another, with the releases
    /// between them. Its length is its number of captures. A phase of pre-attached blocks has none.
    pub chains: Vec<Vec<EventId>>,
    /// Edges that this order does not need, because another capture by the same block comes
    /// earlier. Empty unless blocks can have several active faces.
    pub unneeded: FxHashSet<EdgeIndex>,
}

impl Order {
    /// Returns the events of each phase. Every event comes after all events that it waits for.
    pub(crate) fn by_phase(&self, plan: &ExpandedProgram) -> Vec<Vec<EventId>> {
        let mut events = vec![Vec::new(); plan.phases.len()];
        for &id in &self.events {
            if let Some(phase) = plan.phase_of(id) {
                events[phase].push(id);
            }
        }
        events
    }

    /// Returns the number of captures in a chain.
    pub fn length(plan: &ExpandedProgram, chain: &[EventId]) -> usize {
        chain.iter().filter(|id| is_capture(plan, **id)).count()
    }

    /// Returns the number of captures in the longest chains of all phases.
    pub fn critical_path_length(&self, plan: &ExpandedProgram) -> usize {
        let lengths = self.chains.iter().map(|chain| Order::length(plan, chain));
        lengths.sum()
    }

    /// Returns the phase with the longest chain, and the chain. Returns `None` for a program
    /// without phases.
    pub fn longest(&self, plan: &ExpandedProgram) -> Option<(usize, &[EventId])> {
        (self.chains.iter().enumerate())
            .max_by_key(|(number, chain)| (Order::length(plan, chain), std::cmp::Reverse(*number)))
            .map(|(number, chain)| (number, chain.as_slice()))
    }
}

/// Largest number of cycles that are reported.
const MAX_CYCLES: usize = 10;

/// Sorts the events. Returns `None` and reports the cycles if there are any.
///
/// # Errors
///
/// Returns [`Cancelled`] if the check was cancelled.
pub fn sort(
    plan: &ExpandedProgram,
    graph: &DependencyGraph,
    symbols: &Symbols,
    sources: &Sources,
    cancellation: Cancellation<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Result<Option<Order>, Cancelled> {
    let mut unneeded = FxHashSet::default();
    if face_turns::has_choice(graph) {
        // Length in captures.
        let length = |i: usize| f64::from(is_capture(plan, EventId(i as u32)));
        unneeded = face_turns::unneeded(graph, &face_turns::earliest(graph, length));
    }
    let edges = |node, direction| needed(graph, &unneeded, node, direction);
    // Kahn's algorithm keeps independent events in source order.
    let mut missing: Vec<u32> = (graph.node_indices())
        .map(|node| edges(node, Incoming).count() as u32)
        .collect();
    let mut order = Order::default();
    order.events.reserve(graph.node_count());
    let ready = |node: &NodeIndex| missing[node.index()] == 0 && plan.event(graph[*node]).valid;
    let mut queue: std::collections::VecDeque<NodeIndex> =
        graph.node_indices().filter(ready).collect();
    // Longest chain that ends in each event: its length, and the event before.
    let mut best: Vec<(u32, u32)> = vec![(0, u32::MAX); graph.node_count()];
    while let Some(node) = queue.pop_front() {
        cancellation.check()?;
        let id = graph[node];
        best[node.index()].0 += u32::from(is_capture(plan, id));
        let length = best[node.index()].0;
        order.events.push(id);
        // petgraph lists the newest edge first.
        for edge in edges(node, Outgoing) {
            let next = edge.target().index();
            if best[next].1 == u32::MAX || length > best[next].0 {
                best[next] = (length, id.0);
            }
            missing[next] -= 1;
            if missing[next] == 0 {
                queue.push_back(edge.target());
            }
        }
    }
    let valid = plan.events.iter().filter(|event| event.valid).count();
    if order.events.len() < valid {
        let done: FxHashSet<EventId> = order.events.into_iter().collect();
        let rest = graph.filter_map(
            |_, &id| (!done.contains(&id) && plan.event(id).valid).then_some(id),
            |edge, &why| (!unneeded.contains(&edge)).then_some(why),
        );
        report_cycles(plan, &rest, symbols, sources, diagnostics);
        return Ok(None);
    }
    order.chains = (plan.phases.iter())
        .map(|phase| {
            if phase.pre_attached {
                Vec::new()
            } else {
                longest_chain(phase.events.clone(), plan, &best)
            }
        })
        .collect();
    order.unneeded = unneeded;
    Ok(Some(order))
}

/// Returns the edges into or out of an event, except unneeded edges.
pub(crate) fn needed<'a>(
    graph: &'a DependencyGraph,
    unneeded: &'a FxHashSet<EdgeIndex>,
    node: NodeIndex,
    direction: Direction,
) -> impl Iterator<Item = EdgeReference<'a, LocatedDependency>> {
    let edges = graph.edges_directed(node, direction);
    edges.filter(|edge| !unneeded.contains(&edge.id()))
}

fn is_capture(plan: &ExpandedProgram, id: EventId) -> bool {
    matches!(plan.event(id).kind, EventKind::Capture { .. })
}

fn longest_chain(
    events: std::ops::Range<u32>,
    plan: &ExpandedProgram,
    best: &[(u32, u32)],
) -> Vec<EventId> {
    let last = events
        .filter(|&id| plan.event(EventId(id)).valid)
        .max_by_key(|&id| (best[id as usize].0, std::cmp::Reverse(id)));
    let mut chain = Vec::new();
    let mut at = last.unwrap_or(u32::MAX);
    while at != u32::MAX {
        chain.push(EventId(at));
        at = best[at as usize].1;
    }
    chain.reverse();
    chain
}

/// Reports the cycles in `rest`, the graph of the events that can never happen.
fn report_cycles(
    plan: &ExpandedProgram,
    rest: &DependencyGraph,
    symbols: &Symbols,
    sources: &Sources,
    diagnostics: &mut Vec<Diagnostic>,
) {
    let mut knots: Vec<Vec<NodeIndex>> = kosaraju_scc(rest);
    knots.retain(|knot| knot.len() > 1 || rest.contains_edge(knot[0], knot[0]));
    for knot in &mut knots {
        knot.sort_unstable();
    }
    knots.sort_unstable();
    for knot in knots.iter().take(MAX_CYCLES) {
        let cycle = shortest_cycle(rest, knot);
        diagnostics.push(describe(plan, rest, &cycle, symbols, sources));
    }
}

/// Returns a shortest cycle through the first event of a component, as edges.
fn shortest_cycle(
    graph: &DependencyGraph,
    knot: &[NodeIndex],
) -> Vec<(NodeIndex, NodeIndex, LocatedDependency)> {
    let start = knot[0];
    let inside: FxHashSet<NodeIndex> = knot.iter().copied().collect();
    let mut from: FxHashMap<NodeIndex, (NodeIndex, LocatedDependency)> = FxHashMap::default();
    let mut queue = std::collections::VecDeque::from([start]);
    'search: while let Some(node) = queue.pop_front() {
        for edge in graph.edges_directed(node, Outgoing) {
            let next = edge.target();
            if inside.contains(&next) && !from.contains_key(&next) {
                from.insert(next, (node, *edge.weight()));
                if next == start {
                    break 'search;
                }
                queue.push_back(next);
            }
        }
    }
    let mut cycle = Vec::new();
    let mut at = start;
    while let Some(&(before, why)) = from.get(&at) {
        cycle.push((before, at, why));
        at = before;
        if at == start {
            break;
        }
    }
    cycle.reverse();
    cycle
}

fn describe(
    plan: &ExpandedProgram,
    graph: &DependencyGraph,
    cycle: &[(NodeIndex, NodeIndex, LocatedDependency)],
    symbols: &Symbols,
    sources: &Sources,
) -> Diagnostic {
    /// Largest number of labelled edges of a cycle. The message only counts further edges.
    const MAX_LABELS: usize = 50;
    let count = cycle.len();
    let phase = cycle
        .first()
        .map_or("", |edge| plan.phase_name(graph[edge.1]));
    let event_name = |edge: usize| plan.describe(graph[cycle[edge].1], symbols);
    let what = match count {
        1 => format!("`{}` waits for itself", event_name(0)),
        2 => format!(
            "`{}` and `{}` wait for each other",
            event_name(0),
            event_name(1)
        ),
        count => format!("{count} events wait for each other"),
    };
    let title = format!("phase `{phase}` would deadlock: {what}");
    let mut diagnostic = Diagnostic::new(Code::Cycle, title);
    for &(first, then, why) in cycle.iter().take(MAX_LABELS) {
        let (first, then) = (graph[first], graph[then]);
        let event = plan.event(then);
        let waits = plan.describe(then, symbols);
        let before = plan.describe(first, symbols);
        let (location, text) = match why {
            LocatedDependency::Anchored => {
                let name = match event.kind {
                    EventKind::Capture { parent, .. } => plan.roles.name(parent, symbols),
                    EventKind::Release => plan.roles.name(event.role, symbols),
                };
                (
                    event.location,
                    format!("`{waits}` needs `{name}`, which `{before}` attaches"),
                )
            }
            LocatedDependency::Face { .. } => (
                event.location,
                format!("`{waits}` waits for `{before}`, which comes first in the source"),
            ),
            LocatedDependency::After(location) => {
                (location, format!("`{waits}` waits for `{before}`"))
            }
            LocatedDependency::Emptied => (
                event.location,
                format!("`{waits}` waits for the release of its child: `{before}`"),
            ),
            LocatedDependency::Vacated => (
                event.location,
                format!("`{waits}` needs the cell that `{before}` empties"),
            ),
            LocatedDependency::Freed => (
                event.location,
                format!("`{waits}` needs the name that `{before}` frees"),
            ),
        };
        diagnostic = diagnostic.label(location, text);
    }
    let why = |kind: fn(&LocatedDependency) -> bool| cycle.iter().any(|(_, _, why)| kind(why));
    let waits = (cycle.iter()).find_map(|&(first, then, why)| match why {
        LocatedDependency::After(location) => Some((graph[first], graph[then], location)),
        _ => None,
    });
    if let Some((first, then, location)) = waits {
        let removed = entry(sources, location, "after");
        let fix = |removed| Fix::remove(removed, "remove this `after`").unsafe_if(true);
        diagnostic.fix = removed.map(fix);
        if is_chain(plan, then, first) {
            let help = format!(
                "remove the `after`: it applies to the first capture of its chain, `{}`, and the others \
                 follow it anyway",
                plan.describe(then, symbols)
            );
            return diagnostic.help(help);
        }
    }
    let help = if count > MAX_LABELS {
        format!(
            "remove one `after`; {} more steps of the cycle are not shown",
            count - MAX_LABELS
        )
    } else if why(|why| matches!(why, LocatedDependency::Face { .. })) {
        "swap the two captures, or remove the `after`: a block captures in the order of the source"
            .to_owned()
    } else if waits.is_some() && count == 1 {
        "remove the `after`".to_owned()
    } else if waits.is_some() {
        "remove one `after`, or move one capture into a later phase".to_owned()
    } else {
        "start from a seed, or from a block that is attached earlier".to_owned()
    };
    diagnostic.help(help)
}

/// Returns whether a single chain makes all captures from `first` to `last`.
fn is_chain(plan: &ExpandedProgram, first: EventId, last: EventId) -> bool {
    let follows = |id: u32| {
        let (one, next) = (plan.event(EventId(id)), plan.event(EventId(id + 1)));
        let (one, next) = (one.location, next.location);
        one.file == next.file && (one.span.start..one.span.end).contains(&next.span.start)
    };
    // A capture may wait for its own block, and others follow it.
    let is_last = last.0 as usize + 1 == plan.events.len();
    match first.cmp(&last) {
        Ordering::Less => (first.0..last.0).all(follows),
        Ordering::Equal => !is_last && follows(first.0),
        Ordering::Greater => false,
    }
}
