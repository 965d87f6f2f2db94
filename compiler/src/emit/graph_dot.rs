//! The dependency graph for Graphviz.
use std::fmt::Write as _;

use stochc_grammar::Symbols;

use super::graph_text::{label, waits};
use crate::graph::{Dependency, DependencyGraph};
use crate::order::Order;
use crate::plan::{Deed, Plan};

/// The graph in DOT: a box for each phase, the longest chain of each drawn thick.
pub fn graph_dot(plan: &Plan, graph: &DependencyGraph, order: &Order, symbols: &Symbols) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(out, "digraph {} {{", quoted(&plan.name));
    out.push_str("    rankdir=LR;\n    node [shape=box, style=rounded, fontname=\"Helvetica\"];\n");
    out.push_str("    edge [fontname=\"Helvetica\", fontsize=10];\n");
    for (number, (phase, chain)) in plan.phases.iter().zip(&order.chains).enumerate() {
        let _ = writeln!(out, "    subgraph cluster_{number} {{");
        let _ = writeln!(out, "        label={};", quoted(&phase.name));
        for id in plan.events_of(phase) {
            let style = match plan.event(id).deed {
                Deed::Release => ", style=\"rounded,dashed\"",
                Deed::Capture { .. } if chain.contains(&id) => ", penwidth=2.5",
                Deed::Capture { .. } => "",
            };
            let label = quoted(&plan.describe(id, symbols));
            let _ = writeln!(out, "        e{} [label={label}{style}];", id.0);
        }
        for id in plan.events_of(phase) {
            for (why, first) in waits(graph, id) {
                let style = match why {
                    Dependency::Anchored => String::new(),
                    why => format!(" [label=\"{}\", style=dashed]", label(why)),
                };
                let _ = writeln!(out, "        e{} -> e{}{style};", first.0, id.0);
            }
        }
        out.push_str("    }\n");
    }
    out.push_str("}\n");
    out
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
