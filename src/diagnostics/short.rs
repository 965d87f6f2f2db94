//! Diagnostics on single lines, for editors and `grep`.
use stochc_compiler::diagnostic::{Diagnostic, visible};
use stochc_compiler::{Checked, Sources};

pub fn show(checked: &Checked) -> String {
    let lines = checked.diagnostics.iter();
    lines
        .map(|diagnostic| line(diagnostic, &checked.sources))
        .collect()
}

/// Returns the warnings of a file, one line each.
pub fn warning_lines(checked: &Checked) -> String {
    let warnings = checked.diagnostics.iter();
    let warnings = warnings.filter(|diagnostic| !diagnostic.is_error());
    warnings
        .map(|diagnostic| line(diagnostic, &checked.sources))
        .collect()
}

fn line(diagnostic: &Diagnostic, sources: &Sources) -> String {
    let severity = diagnostic.severity.name();
    let place = diagnostic.labels.first().map_or_else(String::new, |label| {
        let (line, column) = sources
            .file(label.location.file)
            .position(label.location.span.start);
        let name = stochc_text::visible(&sources.file(label.location.file).name);
        format!("{name}:{line}:{column}: ")
    });
    let title = visible(&diagnostic.message());
    format!("{place}{severity}[{}]: {title}\n", diagnostic.code)
}
