//! The dependency graph as text.
use std::fmt::{Display, Formatter};

use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use stochc_grammar::Symbols;

use super::Text;
use crate::graph::{Dependency, DependencyGraph};
use crate::order::Order;
use crate::plan::{EventId, Plan};

/// The graph phase by phase: each event with what it waits for, then the longest chain.
pub fn graph_text(
    plan: &Plan,
    graph: &DependencyGraph,
    order: &Order,
    symbols: &Symbols,
) -> impl Display {
    Text(move |out: &mut Formatter<'_>| {
        if plan.aggregate.is_some() {
            return writeln!(out, "aggregate {}: nothing is ordered", plan.name);
        }
        writeln!(out, "assembly {}", plan.name)?;
        for (phase, chain) in plan.phases.iter().zip(&order.chains) {
            let planted = if phase.planted {
                ", attached by hand"
            } else {
                ""
            };
            writeln!(out, "\nphase {}{planted}", phase.name)?;
            for id in plan.events_of(phase) {
                writeln!(out, "    {}", plan.describe(id, symbols))?;
                for (why, first) in waits(graph, id) {
                    let first = plan.describe(first, symbols);
                    writeln!(out, "        {}: {first}", label(why))?;
                }
            }
            if phase.planted {
                continue;
            }
            writeln!(
                out,
                "    longest serial chain, {}: {}",
                Order::length(plan, chain),
                chain_text(plan, chain, symbols)
            )?;
        }
        Ok(())
    })
}

/// What an event waits for, sorted.
pub(super) fn waits(graph: &DependencyGraph, id: EventId) -> Vec<(Dependency, EventId)> {
    let node = NodeIndex::new(id.0 as usize);
    let mut waits: Vec<_> = graph
        .edges_directed(node, Incoming)
        .map(|edge| (*edge.weight(), graph[edge.source()]))
        .collect();
    waits.sort_unstable_by_key(|&(why, first)| (first, why.word()));
    waits.dedup_by_key(|(why, first)| (*first, why.word()));
    waits
}

/// Why an event waits for another: `after`, or `face, 1 of 2`.
pub(super) fn label(why: Dependency) -> String {
    match why {
        Dependency::Face { needed, of } if needed < of => {
            format!("{}, {needed} of {of}", why.word())
        }
        why => why.word().to_owned(),
    }
}

/// A chain in one line; the middle of a long one is left out.
pub fn chain_text(plan: &Plan, chain: &[EventId], symbols: &Symbols) -> String {
    /// Events shown of a long chain.
    const SHOWN: usize = 12;
    let describe = |ids: &[EventId]| -> Vec<String> {
        ids.iter().map(|&id| plan.describe(id, symbols)).collect()
    };
    if chain.is_empty() {
        return "nothing".to_owned();
    }
    if chain.len() <= SHOWN + 2 {
        return describe(chain).join(", ");
    }
    let (head, tail) = (&chain[..SHOWN / 2], &chain[chain.len() - SHOWN / 2..]);
    format!(
        "{}, ... {} more ..., {}",
        describe(head).join(", "),
        chain.len() - SHOWN,
        describe(tail).join(", ")
    )
}
