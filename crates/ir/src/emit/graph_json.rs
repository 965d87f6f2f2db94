//! Dependency graph as JSON.
use serde_json::json;

use crate::Json;
use crate::graph::{Dependency, EventAction, EventGraph, EventId};
use crate::table::{PhaseId, Tables};

/// Returns the graph as `{ assembly, phases: [{ name, events: [{ id, event, kind, block, parent,
/// face, after: [{ event, why }] }], longest_chain: [id] }] }`.
///
/// A release with a time has its `delay` in ticks.
/// If edges have `enough: n`, n of them suffice. A phase of pre-attached blocks also has `planted:
/// true`, here and in the tables, and no chain.
pub fn graph_json<'a>(graph: &'a EventGraph, tables: &'a Tables) -> Json<'a> {
    let phases = move || {
        let phases = (0..).map(PhaseId).zip(&tables.phases).zip(&graph.chains);
        phases.map(move |((id, phase), chain)| {
            let events = move || graph.events_of(id).map(move |id| event(graph, tables, id));
            let mut fields = vec![
                ("name", phase.name.as_str().into()),
                ("events", Json::list(events)),
                ("longest_chain", Json::each(chain, |id| id.0.into())),
            ];
            if phase.pre_attached {
                fields.push(("pre_attached", true.into()));
            }
            Json::object(fields)
        })
    };
    Json::object([
        ("assembly", tables.assembly.as_str().into()),
        ("phases", Json::list(phases)),
    ])
}

fn event<'a>(graph: &'a EventGraph, tables: &'a Tables, id: EventId) -> Json<'a> {
    let action = graph.event(id).action;
    let (kind, parent, face) = match action {
        EventAction::Capture { parent, face, .. } => {
            ("capture", Some(tables.name(parent)), Some(face))
        }
        EventAction::Release { .. } => ("release", None, None),
    };
    let after = |edge: &crate::graph::Edge| {
        let mut value = json!({ "event": edge.first.0, "why": edge.why.word() });
        if let Dependency::Face { needed, .. } = edge.why
            && edge.why.is_choice()
        {
            value["enough"] = json!(needed);
        }
        value.into()
    };
    let mut fields = vec![
        ("id", id.0.into()),
        ("event", graph.describe(id, tables).into()),
        ("kind", kind.into()),
        ("block", tables.name(action.child()).into()),
        ("parent", parent.into()),
        ("face", json!(face).into()),
        ("after", Json::each(graph.waits_for(id), after)),
    ];
    if graph.event(id).delay > 0 {
        fields.push(("delay", graph.event(id).delay.into()));
    }
    Json::object(fields)
}
