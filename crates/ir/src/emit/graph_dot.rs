//! Dependency graph for Graphviz.
use std::fmt::{self, Display, Formatter};

use super::Text;
use super::graph_text::label;
use crate::graph::{Dependency, EventAction, EventGraph};
use crate::table::{PhaseId, Tables};

/// Returns the graph in DOT: a box for each phase, with its critical path in bold.
pub fn graph_dot(graph: &EventGraph, tables: &Tables) -> impl Display {
    Text(move |out: &mut Formatter<'_>| write_dot(out, graph, tables))
}

fn write_dot(out: &mut Formatter<'_>, graph: &EventGraph, tables: &Tables) -> fmt::Result {
    writeln!(out, "digraph {} {{", quoted(&tables.assembly))?;
    out.write_str(
        "    rankdir=LR;\n    node [shape=box, style=rounded, fontname=\"Helvetica\"];\n",
    )?;
    out.write_str("    edge [fontname=\"Helvetica\", fontsize=10];\n")?;
    for ((number, phase), chain) in (0..).zip(&tables.phases).zip(&graph.chains) {
        writeln!(out, "    subgraph cluster_{number} {{")?;
        writeln!(out, "        label={};", quoted(&phase.name))?;
        for id in graph.events_of(PhaseId(number)) {
            let style = match graph.event(id).action {
                EventAction::Release { .. } => ", style=\"rounded,dashed\"",
                EventAction::Capture { .. } if chain.contains(&id) => ", penwidth=2.5",
                EventAction::Capture { .. } => "",
            };
            let label = quoted(&graph.describe(id, tables));
            writeln!(out, "        e{} [label={label}{style}];", id.0)?;
        }
        for id in graph.events_of(PhaseId(number)) {
            for edge in graph.waits_for(id) {
                let style = match edge.why {
                    Dependency::Anchored => String::new(),
                    why => format!(" [label=\"{}\", style=dashed]", label(why)),
                };
                writeln!(out, "        e{} -> e{}{style};", edge.first.0, id.0)?;
            }
        }
        out.write_str("    }\n")?;
    }
    out.write_str("}\n")
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
