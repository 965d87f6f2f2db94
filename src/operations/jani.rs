//! The rate model of a program as a Markov chain in the format JANI.
//!
//! # Source
//!
//! C. E. Budde, C. Dehnert, E. M. Hahn, A. Hartmanns, S. Junges and A. Turrini, "JANI: Quantitative
//! Model and Tool Interaction", TACAS 2017.
use serde_json::{Value, json};
use stochc_ir::claim::{Claim, ClaimedEvent};
use stochc_results::EnsembleProgram;
use stochc_runtime::rates::{Rates, STAGES, Wait, serial_captures};

use super::rates::supported;
use crate::exit::Failure;

/// Largest probability that an arriving block finds as many docking blocks as the chain counts.
const LOST: f64 = 1e-10;

/// Returns the rate model of a program as a continuous-time Markov chain. Its unit of time is the
/// tick.
///
/// # Errors
///
/// If the scene has no built-in rates, or if captures do not happen one after the other.
pub fn to_jani(program: &EnsembleProgram) -> Result<Value, Failure> {
    supported(program)?;
    let name = &program.name;
    let rates = Rates::built_in(&program.scene).ok_or_else(|| {
        Failure::usage(format!(
            "the scene of `{name}` has no built-in rates for a Markov chain"
        ))
    })?;
    let captures = serial_captures(program.parts(), rates).ok_or_else(|| {
        Failure::usage(format!(
            "`{name}` cannot be written as a Markov chain: its captures must happen one after the \
             other, without releases, timeouts, `wait`, faults and delays of messages"
        ))
    })?;
    let waits: Vec<Wait> = captures.iter().map(|it| it.wait()).collect();
    let largest = waits.iter().map(|wait| wait.rate * wait.docking);
    let most = largest.map(docking_blocks).max().unwrap_or(1);
    let edges = waits.iter().enumerate();
    let edges: Vec<Value> = edges
        .flat_map(|(number, wait)| edges_of(number, *wait, most))
        .collect();
    let variable = |name: &str, most: usize| {
        let kind =
            json!({ "kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": most });
        json!({ "name": name, "type": kind, "initial-value": 0 })
    };
    let is_complete = operation("=", &json!("captures"), &json!(waits.len()));
    let properties = (program.claims.iter())
        .filter_map(|claim| property(claim, &claim.describe(program.tables()), &is_complete));
    Ok(json!({
        "jani-version": 1,
        "name": name,
        "type": "ctmc",
        "metadata": {
            "description": "Rate model of a program for stochc. The unit of time is the tick. \
                `first` and `second` are the numbers of blocks in each stage of docking.",
        },
        "variables": [
            variable("captures", waits.len()),
            variable("first", most),
            variable("second", most),
        ],
        "properties": properties.collect::<Vec<_>>(),
        "automata": [{
            "name": "structure",
            "locations": [{ "name": "run" }],
            "initial-locations": ["run"],
            "edges": edges,
        }],
        "system": { "elements": [{ "automaton": "structure" }] },
    }))
}

/// Returns the number of docking blocks that the chain counts. `mean` is the mean number of docking
/// blocks without captures. This number has a Poisson distribution.
fn docking_blocks(mean: f64) -> usize {
    let (mut count, mut term, mut below) = (0, (-mean).exp(), 0.0);
    while 1.0 - below > LOST && count < 1000 {
        below += term;
        count += 1;
        term *= mean / count as f64;
    }
    count.max(1)
}

/// Returns the transitions before a capture: a block arrives, finishes the first stage, and docks.
fn edges_of(number: usize, wait: Wait, most: usize) -> [Value; 3] {
    const { assert!(STAGES == 2) };
    let stage = f64::from(STAGES) / wait.docking;
    let change = |name: &str, by: i32| {
        let value = operation("+", &json!(name), &json!(by));
        json!({ "ref": name, "value": value })
    };
    let set = |name: &str| json!({ "ref": name, "value": 0 });
    let docking = operation("+", &json!("first"), &json!("second"));
    let is_positive = |name: &str| operation("<", &json!(0), &json!(name));
    let edge = |guard: Value, rate: Value, assignments: Value| {
        let is_waiting = operation("=", &json!("captures"), &json!(number));
        let guard = operation("∧", &is_waiting, &guard);
        json!({
            "location": "run",
            "guard": { "exp": guard },
            "rate": { "exp": rate },
            "destinations": [{ "location": "run", "assignments": assignments }],
        })
    };
    [
        edge(
            operation("<", &docking, &json!(most)),
            json!(wait.rate),
            json!([change("first", 1)]),
        ),
        edge(
            is_positive("first"),
            operation("*", &json!("first"), &json!(stage)),
            json!([change("first", -1), change("second", 1)]),
        ),
        edge(
            is_positive("second"),
            operation("*", &json!("second"), &json!(stage)),
            json!([change("captures", 1), set("first"), set("second")]),
        ),
    ]
}

fn operation(op: &str, left: &Value, right: &Value) -> Value {
    json!({ "op": op, "left": left, "right": right })
}

/// Returns the probability in a claim about completion as a property. Returns `None` for other
/// claims.
fn property(claim: &Claim, name: &str, is_complete: &Value) -> Option<Value> {
    let Claim::Probability {
        event: ClaimedEvent::Completion,
        within: Some(within),
        ..
    } = claim
    else {
        return None;
    };
    let complete = json!({ "op": "F", "exp": is_complete, "time-bounds": { "upper": within } });
    let probability = json!({ "op": "Pmin", "exp": complete });
    Some(json!({
        "name": name,
        "expression": {
            "op": "filter",
            "fun": "values",
            "values": probability,
            "states": { "op": "initial" },
        },
    }))
}

#[cfg(test)]
mod tests {
    use super::docking_blocks;

    #[test]
    fn enough_docking_blocks_are_counted() {
        // P(X >= 10) = 1.7e-10 and P(X >= 11) = 7.7e-12 for a Poisson variable with mean 0.5.
        assert_eq!(docking_blocks(0.5), 11);
        assert_eq!(docking_blocks(0.0), 1);
    }
}
