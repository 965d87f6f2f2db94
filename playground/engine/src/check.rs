//! Checks of programs, with the data of the preview.
use serde_json::{Value, json};
use stochc_compiler::diagnostic::{diagnostics_json, program_json};
use stochc_compiler::expanded::EventKind;
use stochc_compiler::{Checked, LintLevels, MAX_ESTIMATED, Program, check_texts};
use stochc_estimate::Rates;
use stochc_ir::emit::{graph_json, shell_json, table_json};

use crate::examples::EXAMPLES;

/// Name of the program in diagnostics.
pub const NAME: &str = "program.sa";

/// Largest number of captures that an estimate lists.
const MAX_CAPTURES: usize = 5;

/// Returns the result of checking a text. The text may import the examples.
pub fn checked(text: &str) -> Checked {
    let mut texts = vec![(NAME, text)];
    texts.extend(EXAMPLES);
    check_texts(&texts, &LintLevels::default(), "", &[])
}

/// Returns `{ diagnostics, programs }` as `stochc check --format json` does, with the `structure`
/// of each program.
pub fn check(text: &str) -> Value {
    let checked = checked(text);
    let programs = checked
        .programs
        .iter()
        .enumerate()
        .map(|(number, program)| {
            let mut value = program_json(NAME, &checked, number);
            value["structure"] = structure(&checked, program);
            value["has_rates"] = json!(
                program
                    .scene
                    .as_ref()
                    .is_some_and(|scene| Rates::built_in(scene).is_some())
            );
            value
        });
    json!({
        "programs": programs.collect::<Vec<_>>(),
        "diagnostics": diagnostics_json(&checked).collect::<Vec<_>>(),
    })
}

/// Returns the data of a program for the viewer, and its events in a possible order.
///
/// Returns null if the program has errors, except for errors that let a run get stuck.
fn structure(checked: &Checked, program: &Program) -> Value {
    let tables = program.tables.as_ref().or(program.stuck.as_ref());
    let (Some(tables), Some(scene), Some(order)) = (tables, &program.scene, &program.order) else {
        return Value::Null;
    };
    let plan = &program.plan;
    let mut events = order.events.clone();
    // The sort is stable: within a phase, the order does not change.
    events.sort_by_key(|&id| plan.phase_of(id));
    let events = events.into_iter().map(|id| {
        let event = plan.event(id);
        let location = event.location;
        let file = checked.sources.file(location.file);
        let (parent, face) = match event.kind {
            EventKind::Capture { parent, face } => (Some(parent), Some(face)),
            EventKind::Release => (None, None),
        };
        json!({
            "id": id,
            "phase": plan.phase_of(id),
            "role": event.role,
            "parent": parent,
            "face": face,
            "cell": parent.and(program.layout.cells[id.0 as usize]),
            "is_own": file.name == NAME,
            "start": file.offset(location.span.start),
            "end": file.offset(location.span.end),
            "text": plan.describe(id, &checked.symbols),
        })
    });
    let events: Vec<Value> = events.collect();
    json!({
        "events": events,
        "about": {
            "program": plan.name,
            "scene": scene,
            "shell": shell_json(scene, &tables.plate),
            "tables": table_json(tables),
            "graph": graph_json(&program.event_graph(), tables),
        },
    })
}

/// Returns `{ total, phases, captures, is_guess, tick }`, the estimate for a program by the rate
/// model. Returns null if there is no estimate.
pub fn estimate(text: &str, number: usize) -> Result<Value, String> {
    let checked = checked(text);
    let program = checked
        .programs
        .get(number)
        .ok_or("there is no such program")?;
    let Some(scene) = program.scene.as_ref() else {
        return Ok(Value::Null);
    };
    let plan = &program.plan;
    if plan.events.is_empty() || plan.events.len() > MAX_ESTIMATED {
        return Ok(Value::Null);
    }
    let rates = Rates::known_or_guessed(&[], scene);
    let Some(cost) = program.estimate(rates.as_deref()) else {
        return Ok(Value::Null);
    };
    let phases = plan.phases.iter().zip(&cost.phases);
    let phases = phases.filter(|(phase, _)| !phase.pre_attached);
    let phases = phases.map(|(phase, cost)| json!({ "name": phase.name, "times": cost.times }));
    let captures = cost.captures.iter().take(MAX_CAPTURES);
    let captures = captures.map(|it| {
        json!({
            "event": it.event,
            "text": plan.describe(it.event, &checked.symbols),
            "wait": it.wait,
            "share": it.share,
        })
    });
    Ok(json!({
        "total": cost.total,
        "lower_bound": cost.lower_bound,
        "phases": phases.collect::<Vec<_>>(),
        "captures": captures.collect::<Vec<_>>(),
        "is_guess": rates.as_deref().is_some_and(Rates::is_guess),
        "tick": scene.tick,
    }))
}
