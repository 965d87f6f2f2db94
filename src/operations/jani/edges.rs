//! Transitions of a Markov chain in the format JANI.
use serde_json::{Value, json};
use stochc_ir::graph::EventId;
use stochc_runtime::rates::{CaptureState, STAGES};

use super::docking::DockingCounters;

/// Returns the transitions of all states: a block arrives, finishes the first stage, and docks.
/// `describe` returns the text of a capture.
pub fn edges(
    states: &[CaptureState],
    counters: &DockingCounters,
    describe: impl Fn(EventId) -> String,
) -> Vec<Value> {
    const { assert!(STAGES == 2) };
    let mut edges = Vec::new();
    for (number, state) in states.iter().enumerate() {
        let same = |guard: &Value, rate: &Value, assignments: &[Value]| {
            edge([number, number], guard, rate, assignments)
        };
        for (index, counter) in counters.of_state(number).enumerate() {
            let (first, second) = (first(index), second(index));
            let stage = f64::from(STAGES) / counter.docking;
            let docking = operation("+", &json!(first), &json!(second));
            let docked = |rate: f64| {
                let per_block = stage * (rate / counter.arrivals);
                operation("*", &json!(second), &json!(per_block))
            };
            edges.push(same(
                &operation("<", &docking, &json!(counter.most)),
                &json!(counter.arrivals),
                &[change(&first, 1)],
            ));
            edges.push(same(
                &is_positive(&first),
                &operation("*", &json!(first), &json!(stage)),
                &[change(&first, -1), change(&second, 1)],
            ));
            let at_counter =
                (state.open.iter()).filter(|open| counters.index(number, open) == index);
            let rates = at_counter.clone().map(|open| open.wait.rate);
            let ignored = counter.arrivals - rates.sum::<f64>();
            for open in at_counter {
                let ends = [number, open.next];
                let after = after_capture(counters, ends, index);
                let mut capture =
                    edge(ends, &is_positive(&second), &docked(open.wait.rate), &after);
                capture["comment"] = json!(describe(open.event));
                edges.push(capture);
            }
            if ignored > 0.0 {
                edges.push(same(
                    &is_positive(&second),
                    &docked(ignored),
                    &[change(&second, -1)],
                ));
            }
        }
    }
    edges
}

/// Returns the assignments of a capture at a face of the counter `docked`. Counters that continue
/// keep their other blocks.
fn after_capture(
    counters: &DockingCounters,
    [before, after]: [usize; 2],
    docked: usize,
) -> Vec<Value> {
    let used = counters.of_state(before).count();
    let mut origins: Vec<Option<usize>> = counters.origins(before, after).collect();
    origins.resize(used.max(origins.len()), None);
    let mut assignments = vec![change("captures", 1)];
    for (index, origin) in origins.into_iter().enumerate() {
        let values = match origin {
            Some(origin) if origin == docked => [json!(first(origin)), sum(&second(origin), -1)],
            Some(origin) => [json!(first(origin)), json!(second(origin))],
            None if index < used => [json!(0), json!(0)],
            None => continue,
        };
        let names = [first(index), second(index)];
        let set = names.into_iter().zip(values);
        let changed = set.filter(|(name, value)| *value != json!(name));
        assignments.extend(changed.map(|(name, value)| assignment(&name, &value)));
    }
    assignments
}

/// Returns a transition between two states.
fn edge([from, to]: [usize; 2], guard: &Value, rate: &Value, assignments: &[Value]) -> Value {
    json!({
        "location": from.to_string(),
        "guard": { "exp": guard },
        "rate": { "exp": rate },
        "destinations": [{ "location": to.to_string(), "assignments": assignments }],
    })
}

/// Returns an expression with an operator of JANI.
pub fn operation(op: &str, left: &Value, right: &Value) -> Value {
    json!({ "op": op, "left": left, "right": right })
}

/// Returns the name of a counter's number of blocks in the first stage.
fn first(index: usize) -> String {
    format!("first_{}", index + 1)
}

/// Returns the name of a counter's number of blocks in the second stage.
fn second(index: usize) -> String {
    format!("second_{}", index + 1)
}

fn sum(name: &str, by: i32) -> Value {
    operation("+", &json!(name), &json!(by))
}

fn assignment(name: &str, value: &Value) -> Value {
    json!({ "ref": name, "value": value })
}

fn change(name: &str, by: i32) -> Value {
    assignment(name, &sum(name, by))
}

fn is_positive(name: &str) -> Value {
    operation("<", &json!(0), &json!(name))
}
