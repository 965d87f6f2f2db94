//! The rate model of a program as a Markov chain in the format JANI.
//!
//! # Source
//!
//! C. E. Budde, C. Dehnert, E. M. Hahn, A. Hartmanns, S. Junges and A. Turrini, "JANI: Quantitative
//! Model and Tool Interaction", TACAS 2017.
mod docking;
mod edges;

use serde_json::{Value, json};
use stochc_ir::claim::{Claim, ClaimedEvent};
use stochc_results::EnsembleProgram;
use stochc_runtime::rates::{Rates, capture_states};

use self::docking::DockingCounters;
use self::edges::{edges, operation};
use super::rates::supported;
use crate::exit::Failure;

/// Limit on the number of sets of captured blocks.
const MAX_SETS: usize = 1000;

/// Returns the rate model of a program as a continuous-time Markov chain. Its unit of time is the
/// tick.
///
/// # Errors
///
/// If the scene has no built-in rates, the program does more than capture, or the chain is too
/// large.
pub fn to_jani(program: &EnsembleProgram) -> Result<Value, Failure> {
    supported(program)?;
    let name = &program.name;
    let rates = Rates::built_in(&program.scene).ok_or_else(|| {
        Failure::usage(format!(
            "the scene of `{name}` has no built-in rates for a Markov chain"
        ))
    })?;
    let refused = |reason: &dyn std::fmt::Display| {
        Failure::usage(format!(
            "`{name}` cannot be written as a Markov chain: {reason}"
        ))
    };
    let states = capture_states(program.parts(), rates, MAX_SETS);
    let states = states.map_err(|reason| refused(&reason))?;
    let counters = DockingCounters::new(&states)
        .ok_or_else(|| refused(&"too many blocks can dock at the same time"))?;
    let captures = states.last().map_or(0, |state| state.captures);
    let variable = |name: String, most: usize| {
        let kind =
            json!({ "kind": "bounded", "base": "int", "lower-bound": 0, "upper-bound": most });
        json!({ "name": name, "type": kind, "initial-value": 0 })
    };
    let mut variables = vec![variable("captures".to_owned(), captures)];
    for (number, most) in (1..).zip(counters.most()) {
        variables.push(variable(format!("first_{number}"), most));
        variables.push(variable(format!("second_{number}"), most));
    }
    let locations = (0..states.len()).map(|state| json!({ "name": state.to_string() }));
    let describe = |event| program.parts().graph.describe(event, program.tables());
    let is_complete = operation("=", &json!("captures"), &json!(captures));
    let properties = (program.claims.iter())
        .filter_map(|claim| property(claim, &claim.describe(program.tables()), &is_complete));
    let description = format!(
        "Rate model of a program for stochc. The unit of time is the tick. `first_1`, `second_1` and \
         so on are numbers of blocks in each stage of docking. An arriving block is ignored with a \
         probability of at most {:e}.",
        counters.lost
    );
    Ok(json!({
        "jani-version": 1,
        "name": name,
        "type": "ctmc",
        "metadata": { "description": description },
        "variables": variables,
        "properties": properties.collect::<Vec<_>>(),
        "automata": [{
            "name": "structure",
            "locations": locations.collect::<Vec<_>>(),
            "initial-locations": ["0"],
            "edges": edges(&states, &counters, describe),
        }],
        "system": { "elements": [{ "automaton": "structure" }] },
    }))
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
