//! Findings on a terminal, one to a line, or as JSON.
use clap::ValueEnum;
use serde_json::{Value, json};
use stochc_compiler::finding::{Finding, Renderer, Severity};
use stochc_compiler::{Checked, Site, Sources};

/// How findings are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Over the text they speak of.
    Graphical,
    /// `file:line:column: severity[code]: message`, one to a line.
    Short,
    /// One JSON document.
    Json,
}

/// Findings that are drawn at most; the rest are counted.
const MOST_DRAWN: usize = 50;

/// The findings of a file in a form, ready to print; empty if there is nothing to say.
pub fn show(checked: &Checked, format: Format, colour: bool, width: usize) -> String {
    match format {
        Format::Graphical => graphical(checked, colour, width),
        Format::Short => (checked.findings.iter())
            .map(|finding| short(finding, &checked.sources))
            .collect(),
        Format::Json => format!("{:#}\n", Value::Array(values(checked).collect())),
    }
}

fn graphical(checked: &Checked, colour: bool, width: usize) -> String {
    let renderer = Renderer::new(colour, width);
    let mut out = String::new();
    for finding in checked.findings.iter().take(MOST_DRAWN) {
        out.push_str(&renderer.render(finding, &checked.sources));
        out.push('\n');
    }
    let rest = checked.findings.len().saturating_sub(MOST_DRAWN);
    if rest > 0 {
        out.push_str(&format!(
            "{rest} more findings; `--format short` shows all of them\n\n"
        ));
    }
    out
}

fn short(finding: &Finding, sources: &Sources) -> String {
    let severity = match finding.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    let place = finding.labels.first().map_or_else(String::new, |label| {
        let (line, column) = position(sources, label.site, label.site.span.start);
        format!("{}:{line}:{column}: ", sources.file(label.site.file).name)
    });
    let title = stochc_compiler::finding::visible(&finding.title);
    format!("{place}{severity}[{}]: {title}\n", finding.code)
}

/// The findings of a file as JSON, each as
/// `{ code, severity, title, help, labels: [{ file, start, end, text }] }`; `start` and `end` have
/// `offset` in bytes from 0, `line` and `column` from 1, the column in characters.
pub fn values(checked: &Checked) -> impl Iterator<Item = Value> {
    (checked.findings.iter()).map(|finding| value(finding, &checked.sources))
}

fn value(finding: &Finding, sources: &Sources) -> Value {
    let point = |site: Site, at: u32| {
        let (line, column) = position(sources, site, at);
        json!({ "offset": at, "line": line, "column": column })
    };
    let labels: Vec<Value> = (finding.labels.iter())
        .map(|label| {
            json!({
                "file": sources.file(label.site.file).name,
                "start": point(label.site, label.site.span.start),
                "end": point(label.site, label.site.span.end),
                "text": label.text,
            })
        })
        .collect();
    json!({
        "code": finding.code,
        "severity": finding.severity,
        "title": finding.title,
        "help": finding.help,
        "labels": labels,
    })
}

fn position(sources: &Sources, site: Site, at: u32) -> (usize, usize) {
    sources.file(site.file).position(at)
}
