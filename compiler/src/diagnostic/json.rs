//! Diagnostics and programs as JSON.
use serde_json::{Value, json};

use super::{Diagnostic, Fix};
use crate::{Checked, SourceLocation, Sources};

/// Returns a program with its proof. The proof is `null` if there is none.
pub fn program_json(file: &str, checked: &Checked, number: usize) -> Value {
    let program = &checked.programs[number];
    let plan = &program.plan;
    let (captures, releases) = plan.counts();
    let pre_attached = plan.pre_attached();
    json!({
        "file": file,
        "name": plan.name,
        "kind": match plan.aggregate {
            Some(_) => "aggregate",
            None => "assembly",
        },
        "scene": program.scene.as_ref().map(|scene| &scene.name),
        "phases": plan.phases.iter().filter(|phase| !phase.pre_attached).count(),
        "pre_attached": pre_attached,
        "captures": captures - pre_attached,
        "releases": releases,
        "proved": checked.proof(number),
    })
}

/// Returns the diagnostics of a file as JSON.
///
/// Each is `{ code, severity, title, count, help, labels: [{ file, start, end, text }], fix }`.
/// `count` is more than 1 if one statement has the same error several times, as in a loop. `start`
/// and `end` have an `offset` in bytes from 0, and a `line` and `column` from 1. Columns count
/// characters.
///
/// `fix` is `null` or `{ title, safe, edits: [{ file, start, end, text }] }`. There, `text`
/// replaces the source from `start` to `end`.
pub fn diagnostics_json(checked: &Checked) -> impl Iterator<Item = Value> {
    (checked.diagnostics.iter()).map(|diagnostic| value(diagnostic, &checked.sources))
}

fn value(diagnostic: &Diagnostic, sources: &Sources) -> Value {
    let labels: Value = (diagnostic.labels.iter())
        .map(|label| place(sources, label.location, &label.text))
        .collect();
    json!({
        "code": diagnostic.code,
        "severity": diagnostic.severity,
        "title": diagnostic.message(),
        "count": diagnostic.others.count + 1,
        "help": diagnostic.help,
        "labels": labels,
        "fix": diagnostic.fix.as_ref().map(|fix| change(fix, sources)),
    })
}

fn change(fix: &Fix, sources: &Sources) -> Value {
    let edits: Value = (fix.edits.iter())
        .map(|edit| place(sources, edit.location, &edit.text))
        .collect();
    json!({ "title": fix.title, "safe": fix.safe, "edits": edits })
}

fn place(sources: &Sources, location: SourceLocation, text: &str) -> Value {
    let point = |at: u32| {
        let (line, column) = sources.file(location.file).position(at);
        let offset = sources.file(location.file).offset(at);
        json!({ "offset": offset, "line": line, "column": column })
    };
    json!({
        "file": sources.file(location.file).name,
        "start": point(location.span.start),
        "end": point(location.span.end),
        "text": text,
    })
}
