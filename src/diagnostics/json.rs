//! Findings as JSON.
use serde_json::{Value, json};
use stochc_compiler::finding::{Finding, Fix};
use stochc_compiler::{Checked, Site, Sources};

use super::position;

/// The findings as one document.
pub fn document(findings: Vec<Value>) -> String {
    format!("{:#}\n", Value::Array(findings))
}

/// The findings of a file as JSON, each as
/// `{ code, severity, title, count, help, labels: [{ file, start, end, text }], fix }`; `count` is more
/// than 1 where one statement has been found wrong so many times, as in a loop. `start` and `end` have `offset` in bytes from 0, `line` and `column` from 1, the column in characters. `fix` is
/// `null` or `{ title, safe, edits: [{ file, start, end, text }] }`, where `text` takes the place
/// of what stands from `start` to `end`.
pub fn values(checked: &Checked) -> impl Iterator<Item = Value> {
    (checked.findings.iter()).map(|finding| value(finding, &checked.sources))
}

fn value(finding: &Finding, sources: &Sources) -> Value {
    let labels: Value = (finding.labels.iter())
        .map(|label| place(sources, label.site, &label.text))
        .collect();
    json!({
        "code": finding.code,
        "severity": finding.severity,
        "title": finding.message(),
        "count": finding.others.count + 1,
        "help": finding.help,
        "labels": labels,
        "fix": finding.fix.as_ref().map(|fix| change(fix, sources)),
    })
}

fn change(fix: &Fix, sources: &Sources) -> Value {
    let edits: Value = (fix.edits.iter())
        .map(|edit| place(sources, edit.site, &edit.text))
        .collect();
    json!({ "title": fix.title, "safe": fix.safe, "edits": edits })
}

fn place(sources: &Sources, site: Site, text: &str) -> Value {
    let point = |at: u32| {
        let (line, column) = position(sources, site, at);
        json!({ "offset": at, "line": line, "column": column })
    };
    json!({
        "file": sources.file(site.file).name,
        "start": point(site.span.start),
        "end": point(site.span.end),
        "text": text,
    })
}
