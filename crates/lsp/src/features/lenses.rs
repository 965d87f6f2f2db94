//! Code lenses above programs: the critical path, and commands that simulate the file or test its
//! claims.
use serde_json::{Value, json};
use stochc_compiler::expanded::EventKind;
use stochc_compiler::{FileId, Program};
use stochc_estimate::Cost;
use stochc_grammar::tree::ItemKind;
use stochc_text::{counted, number};

use crate::workspace::analysis::Analysis;

/// Command that clients implement. Its argument is the URI of the file to simulate.
const SIMULATE: &str = "stochc.simulate";

/// Command that clients implement. Its argument is the URI of the file whose claims to test.
const TEST: &str = "stochc.test";

/// Returns the lenses of all programs of the file with a URI.
pub fn lenses(analysis: &Analysis, uri: &str) -> Vec<Value> {
    let lines = analysis.lines(FileId(0));
    let checked = &analysis.checked;
    let is_saved = uri.starts_with("file:");
    let mut lenses = Vec::new();
    for item in &checked.tree.items {
        let name = match &item.kind {
            ItemKind::Assembly(it) => &it.name,
            ItemKind::Aggregate(it) => &it.name,
            _ => continue,
        };
        let word = checked.symbols.word(name.symbol);
        let mut programs = checked.programs.iter().enumerate();
        let Some((number, program)) = programs.find(|(_, it)| it.plan.name == word) else {
            continue;
        };
        let range = lines.range(name.span);
        let mut add = |title: String, command: &str, arguments: &[&str]| {
            let command = json!({ "title": title, "command": command, "arguments": arguments });
            lenses.push(json!({ "range": range, "command": command }));
        };
        if let Some(title) = critical_path(program, analysis.cost(number)) {
            add(title, "", &[]);
        }
        if is_saved && program.tables.is_some() {
            add("▶ simulate".to_owned(), SIMULATE, &[uri]);
            if !program.claims.is_empty() {
                add("▶ test claims".to_owned(), TEST, &[uri]);
            }
        }
    }
    lenses
}

/// Describes the longest critical path of a program, and its completion time if it is known.
/// Returns `None` if the program captures no blocks in order.
fn critical_path(program: &Program, cost: Option<&Cost>) -> Option<String> {
    let order = program.order.as_ref()?;
    let plan = &program.plan;
    let is_capture = |id| matches!(plan.event(id).kind, EventKind::Capture { .. });
    let phases = plan.phases.iter().filter(|phase| !phase.pre_attached);
    let captures: usize = phases
        .map(|phase| plan.events_of(phase).filter(|&id| is_capture(id)).count())
        .sum();
    if captures == 0 {
        return None;
    }
    let path = format!(
        "critical path: {} of {}",
        order.critical_path_length(plan),
        counted(captures, "capture")
    );
    let mean = cost.and_then(|cost| Some((cost.lower_bound.prefix(), cost.total?.mean?)));
    Some(match mean {
        Some((bound, mean)) => format!("{path}, {bound}{} ticks", number(mean.round())),
        None => path,
    })
}
