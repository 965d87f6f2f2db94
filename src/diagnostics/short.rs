//! Findings one to a line, for editors and `grep`.
use stochc_compiler::finding::{Finding, Severity, visible};
use stochc_compiler::{Checked, Sources};

use super::position;

pub fn show(checked: &Checked) -> String {
    let lines = checked.findings.iter();
    lines
        .map(|finding| line(finding, &checked.sources))
        .collect()
}

fn line(finding: &Finding, sources: &Sources) -> String {
    let severity = match finding.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    let place = finding.labels.first().map_or_else(String::new, |label| {
        let (line, column) = position(sources, label.site, label.site.span.start);
        format!("{}:{line}:{column}: ", sources.file(label.site.file).name)
    });
    let title = visible(&finding.message());
    format!("{place}{severity}[{}]: {title}\n", finding.code)
}
