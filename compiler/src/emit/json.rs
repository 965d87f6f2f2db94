//! Event tables and the graph as JSON.
use serde_json::{Value, json};
use stochc_grammar::Symbols;

use super::graph_text::waits;
use crate::graph::{Dependency, DependencyGraph};
use crate::order::Order;
use crate::plan::{Deed, Plan};
use crate::scene::BondKind;
use crate::table::{Action, Condition, Duty, News, Tables, Trigger};

/// Event tables with every name written out.
///
/// `{ assembly, faces, plate: { width, depth }, phases: [{ name, reports, timeout }],
/// blocks: [{ name, seed, duties: [{ phase, trigger, rules: [{ when, then }] }] }] }`; a cell is
/// `[x, y, z]`, a timeout is in ticks. A condition is `{ docked: NAME }`, `{ asked: NAME }`, `{ released: NAME }`,
/// `{ heard: { anchored: NAME } }`, or `{ turn: { enough: n, of: [NAME] } }`: n of these have docked.
///
/// What a rule does to capture and to let go is `magnetize` and `switch_off`, `open` and `close`, or
/// `expect` and `reject`, by the kind of bond. That is said in `bond` if it is not `attract`; where every
/// face always attracts, `otherwise` says what becomes of a block on a face that expects none.
pub fn table_json(tables: &Tables) -> Value {
    let mut blocks: Vec<Value> = (tables.roles.iter())
        .map(|role| json!({ "name": role.name, "seed": role.seed, "duties": [] }))
        .collect();
    for duty in tables.duties() {
        let rules: Vec<Value> = (duty.rules().enumerate())
            .map(|(place, rule)| {
                let when: Vec<Value> = rule
                    .when
                    .iter()
                    .map(|&when| condition(tables, duty, place, when))
                    .collect();
                json!({ "when": when, "then": action(tables, rule.then) })
            })
            .collect();
        let value = json!({
            "phase": tables.phases[duty.phase.0 as usize].name,
            "trigger": match duty.trigger {
                Trigger::Start => "start",
                Trigger::Anchored => "anchored",
            },
            "rules": rules,
        });
        if let Some(Value::Array(duties)) = blocks[duty.role.0 as usize].get_mut("duties") {
            duties.push(value);
        }
    }
    let mut value = json!({
        "assembly": tables.assembly,
        "faces": tables.faces,
        "plate": tables.plate,
        "phases": tables.phases,
        "blocks": blocks,
    });
    if tables.bond != BondKind::default() {
        value["bond"] = json!(tables.bond);
    }
    if let Some(size) = tables.aggregate {
        value["aggregate"] = json!(size);
    } else if tables.bond.is_passive() {
        value["otherwise"] = json!({ "do": "reject", "face": "any other" });
    }
    value
}

/// The verbs of a kind of bond: to capture, and to let go.
fn verbs(bond: BondKind) -> (&'static str, &'static str) {
    match bond {
        BondKind::Attract => ("magnetize", "switch_off"),
        BondKind::Suction => ("open", "close"),
        BondKind::Reject => ("expect", "reject"),
    }
}

fn condition(tables: &Tables, duty: Duty<'_>, place: usize, condition: Condition) -> Value {
    match condition {
        Condition::Turn(needed) => {
            let of: Vec<&str> = duty
                .given_before(place)
                .map(|role| tables.name(role))
                .collect();
            json!({ "turn": { "enough": needed, "of": of } })
        }
        Condition::Docked(role) => json!({ "docked": tables.name(role) }),
        Condition::Asked(role) => json!({ "asked": tables.name(role) }),
        Condition::Released(role) => json!({ "released": tables.name(role) }),
        Condition::Heard(what) => json!({ "heard": news(tables, what) }),
    }
}

fn action(tables: &Tables, action: Action) -> Value {
    let (capture, release) = verbs(tables.bond);
    match action {
        Action::Magnetize { face, child, cell } => {
            json!({ "do": capture, "face": face, "child": tables.name(child), "cell": cell })
        }
        Action::AskRelease => json!({ "do": "ask_release" }),
        Action::SwitchOff { face, child } => {
            json!({ "do": release, "face": face, "child": tables.name(child) })
        }
        Action::Tell { to, news: what } => {
            json!({ "do": "tell", "to": tables.name(to), "news": news(tables, what) })
        }
        Action::Report => json!({ "do": "report" }),
    }
}

fn news(tables: &Tables, news: News) -> Value {
    match news {
        News::Anchored(role) => json!({ "anchored": tables.name(role) }),
        News::Released(role) => json!({ "released": tables.name(role) }),
    }
}

/// The graph: `{ assembly, phases: [{ name, events: [{ id, event, kind, block, parent, face,
/// after: [{ event, why }] }], longest_chain: [id] }] }`. Of the edges with `enough: n`, n are enough. A phase of blocks that are attached by hand has
/// `planted: true` as well, here and in the tables, and no chain.
pub fn graph_json(plan: &Plan, graph: &DependencyGraph, order: &Order, symbols: &Symbols) -> Value {
    let phases: Vec<Value> = (plan.phases.iter().zip(&order.chains))
        .map(|(phase, chain)| {
            let events: Vec<Value> = plan
                .events_of(phase)
                .map(|id| {
                    let event = plan.event(id);
                    let (kind, parent, face) = match event.deed {
                        Deed::Capture { parent, face } => (
                            "capture",
                            Some(plan.roles.name(parent, symbols)),
                            Some(face),
                        ),
                        Deed::Release => ("release", None, None),
                    };
                    let after: Vec<Value> = waits(graph, id)
                        .into_iter()
                        .map(|(why, first)| {
                            let mut edge = json!({ "event": first.0, "why": why.word() });
                            if let Dependency::Face { needed, .. } = why
                                && why.is_choice()
                            {
                                edge["enough"] = json!(needed);
                            }
                            edge
                        })
                        .collect();
                    json!({
                        "id": id.0,
                        "event": plan.describe(id, symbols),
                        "kind": kind,
                        "block": plan.roles.name(event.role, symbols),
                        "parent": parent,
                        "face": face,
                        "after": after,
                    })
                })
                .collect();
            let chain: Vec<u32> = chain.iter().map(|id| id.0).collect();
            let mut value = json!({ "name": phase.name, "events": events, "longest_chain": chain });
            if phase.planted {
                value["planted"] = json!(true);
            }
            value
        })
        .collect();
    json!({ "assembly": plan.name, "phases": phases })
}
