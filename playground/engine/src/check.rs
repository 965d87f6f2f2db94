//! Checks of programs, with the data of the preview.
use serde_json::{Value, json};
use stochc_compiler::diagnostic::{diagnostics_json, program_json};
use stochc_compiler::expanded::{EventId, EventKind, ExpandedProgram};
use stochc_compiler::{
    Changes, Checked, LintLevels, MAX_ESTIMATED, Program, SourceLocation, check_texts,
};
use stochc_estimate::Rates;
use stochc_ir::emit::{graph_json, shell_json, table_json};
use stochc_ir::table::RoleId;

use crate::examples::EXAMPLES;

/// Name of the program in diagnostics.
pub const NAME: &str = "program.sa";

/// Largest number of captures that an estimate lists.
const MAX_CAPTURES: usize = 5;

/// Returns the result of checking a text. The text may import the examples.
pub fn checked(text: &str) -> Checked {
    let mut texts = vec![(NAME, text)];
    texts.extend(EXAMPLES);
    check_texts(&texts, &LintLevels::default(), Changes::NONE)
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
/// If the program has errors, wrong events are listed apart, and there may be no event tables.
/// Returns null if the scene has errors.
fn structure(checked: &Checked, program: &Program) -> Value {
    let Some(scene) = &program.scene else {
        return Value::Null;
    };
    let plan = &program.plan;
    let all = || (0..plan.events.len()).map(|i| EventId(i as u32));
    let mut valid: Vec<EventId> = match &program.order {
        Some(order) => order.events.clone(),
        None => all().filter(|&id| plan.event(id).valid).collect(),
    };
    valid.retain(|id| program.layout.cells[id.0 as usize].is_some());
    // The sort is stable: within a phase, the order does not change.
    valid.sort_by_key(|&id| plan.phase_of(id));
    let range = |location: SourceLocation| {
        let file = checked.sources.file(location.file);
        json!({
            "is_own": file.name == NAME,
            "start": file.offset(location.span.start),
            "end": file.offset(location.span.end),
        })
    };
    let event = |id: EventId| {
        let event = plan.event(id);
        let (parent, face) = match event.kind {
            EventKind::Capture { parent, face } => (Some(parent), Some(face)),
            EventKind::Release => (None, None),
        };
        let mut value = range(event.location);
        value["id"] = json!(id);
        value["phase"] = json!(plan.phase_of(id));
        value["role"] = json!(event.role);
        value["parent"] = json!(parent);
        value["face"] = json!(face);
        value["cell"] = json!(parent.and(program.layout.cells[id.0 as usize]));
        value["text"] = json!(plan.describe(id, &checked.symbols));
        value
    };
    let seeds = plan.seeds.iter().map(|seed| {
        let mut value = range(seed.location);
        value["role"] = json!(seed.role);
        value
    });
    let tables = program.tables.as_ref().or(program.stuck.as_ref());
    json!({
        "is_partial": tables.is_none(),
        "events": valid.into_iter().map(event).collect::<Vec<_>>(),
        "wrong": all().filter(|&id| !plan.event(id).valid).map(event).collect::<Vec<_>>(),
        "seeds": seeds.collect::<Vec<_>>(),
        "about": {
            "program": plan.name,
            "scene": scene,
            "shell": shell_json(scene, &plan.plate),
            "tables": match tables {
                Some(tables) => json!(table_json(tables)),
                None => blocks(checked, plan),
            },
            "graph": match tables {
                Some(tables) => json!(graph_json(&program.event_graph(), tables)),
                None => json!({ "phases": [] }),
            },
        },
    })
}

/// Returns the blocks and phases of a program without event tables, in the format of the tables.
fn blocks(checked: &Checked, plan: &ExpandedProgram) -> Value {
    let blocks = (0..plan.roles.count()).map(|i| {
        let role = RoleId(i as u32);
        // The first roles are the seeds.
        let seed = plan.seeds.get(i);
        json!({
            "name": plan.roles.name(role, &checked.symbols),
            "seed": seed.map(|seed| seed.cell),
            "duties": [],
        })
    });
    let phases = plan.phases.iter();
    let phases =
        phases.map(|phase| json!({ "name": phase.name, "pre_attached": phase.pre_attached }));
    json!({
        "plate": plan.plate,
        "blocks": blocks.collect::<Vec<_>>(),
        "phases": phases.collect::<Vec<_>>(),
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
