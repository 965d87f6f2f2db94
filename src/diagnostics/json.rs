//! Findings as JSON.
use serde_json::{Value, json};
use stochc_compiler::diagnostic::{Diagnostic, Fix};
use stochc_compiler::{Checked, SourceLocation, Sources};

use super::position;

/// The findings as one document.
pub fn document(diagnostics: Vec<Value>) -> String {
    format!("{:#}\n", Value::Array(diagnostics))
}

/// The findings of a file as JSON, each as
/// `{ code, severity, title, count, help, labels: [{ file, start, end, text }], fix }`; `count` is more
/// than 1 where one statement has been found wrong so many times, as in a loop. `start` and `end` have `offset` in bytes of the file from 0, `line` and `column` from 1, the column in characters. `fix` is
/// `null` or `{ title, safe, edits: [{ file, start, end, text }] }`, where `text` takes the place
/// of what stands from `start` to `end`.
pub fn values(checked: &Checked) -> impl Iterator<Item = Value> {
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
        let (line, column) = position(sources, location, at);
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
