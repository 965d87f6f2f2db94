//! Dependency graph as text.
use std::fmt::{self, Display, Formatter};

use super::Text;
use crate::graph::{Dependency, EventGraph};
use crate::table::{PhaseId, Tables};

/// Returns the graph phase by phase: each event with its predecessors, then the critical path.
pub fn graph_text(graph: &EventGraph, tables: &Tables) -> impl Display {
    Text(move |out: &mut Formatter<'_>| write_graph(out, graph, tables))
}

fn write_graph(out: &mut Formatter<'_>, graph: &EventGraph, tables: &Tables) -> fmt::Result {
    if tables.aggregate.is_some() {
        return writeln!(out, "aggregate {}: nothing is ordered", tables.assembly);
    }
    writeln!(out, "assembly {}", tables.assembly)?;
    for ((number, phase), chain) in (0..).zip(&tables.phases).zip(&graph.chains) {
        let pre_attached = if phase.pre_attached {
            ", pre-attached"
        } else {
            ""
        };
        writeln!(out, "\nphase {}{pre_attached}", phase.name)?;
        for id in graph.events_of(PhaseId(number)) {
            writeln!(out, "    {}", graph.describe(id, tables))?;
            for edge in graph.waits_for(id) {
                let first = graph.describe(edge.first, tables);
                writeln!(out, "        {}: {first}", label(edge.why))?;
            }
        }
        if phase.pre_attached {
            continue;
        }
        writeln!(
            out,
            "    longest serial chain, {}: {}",
            graph.length(chain),
            chain_text(chain, |&id| graph.describe(id, tables))
        )?;
    }
    Ok(())
}

/// Returns the reason of a dependency: `after`, or `face, 1 of 2`.
pub(super) fn label(why: Dependency) -> String {
    match why {
        Dependency::Face { needed, of } if needed < of => {
            format!("{}, {needed} of {of}", why.word())
        }
        why => why.word().to_owned(),
    }
}

/// Returns a chain in one line. Omits the middle of a long chain.
pub fn chain_text<T>(chain: &[T], describe: impl Fn(&T) -> String) -> String {
    /// Number of events that are shown of a long chain.
    const SHOWN: usize = 12;
    let describe = |events: &[T]| -> Vec<String> { events.iter().map(&describe).collect() };
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
