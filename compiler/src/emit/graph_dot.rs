//! The dependency graph for Graphviz.
use std::fmt::{Display, Formatter};

use stochc_grammar::Symbols;

use super::Text;
use super::graph_text::{label, waits};
use crate::graph::{Dependency, DependencyGraph};
use crate::order::Order;
use crate::plan::{Deed, Plan};

/// The graph in DOT: a box for each phase, the longest chain of each drawn thick.
pub fn graph_dot(
    plan: &Plan,
    graph: &DependencyGraph,
    order: &Order,
    symbols: &Symbols,
) -> impl Display {
    Text(move |out: &mut Formatter<'_>| {
        writeln!(out, "digraph {} {{", quoted(&plan.name))?;
        out.write_str(
            "    rankdir=LR;\n    node [shape=box, style=rounded, fontname=\"Helvetica\"];\n",
        )?;
        out.write_str("    edge [fontname=\"Helvetica\", fontsize=10];\n")?;
        for (number, (phase, chain)) in plan.phases.iter().zip(&order.chains).enumerate() {
            writeln!(out, "    subgraph cluster_{number} {{")?;
            writeln!(out, "        label={};", quoted(&phase.name))?;
            for id in plan.events_of(phase) {
                let style = match plan.event(id).deed {
                    Deed::Release => ", style=\"rounded,dashed\"",
                    Deed::Capture { .. } if chain.contains(&id) => ", penwidth=2.5",
                    Deed::Capture { .. } => "",
                };
                let label = quoted(&plan.describe(id, symbols));
                writeln!(out, "        e{} [label={label}{style}];", id.0)?;
            }
            for id in plan.events_of(phase) {
                for (why, first) in waits(graph, id) {
                    let style = match why {
                        Dependency::Anchored => String::new(),
                        why => format!(" [label=\"{}\", style=dashed]", label(why)),
                    };
                    writeln!(out, "        e{} -> e{}{style};", first.0, id.0)?;
                }
            }
            out.write_str("    }\n")?;
        }
        out.write_str("}\n")
    })
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}
