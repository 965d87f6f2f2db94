//! Diagnostics in the client's terms.
use std::collections::BTreeMap;

use gen_lsp_types::{
    Code, Diagnostic as LspDiagnostic, DiagnosticRelatedInformation, DiagnosticSeverity,
    DiagnosticTag, Message, Range,
};
use stochc_compiler::diagnostic::{Diagnostic, Severity, visible};

use crate::workspace::analysis::Analysis;
use crate::workspace::documents::Documents;

/// Returns the diagnostics of a program by file path, except for text that was edited after the
/// analysis. The result always contains the program's own file.
pub fn of(
    analysis: &Analysis,
    path: &str,
    documents: &Documents,
) -> BTreeMap<String, Vec<LspDiagnostic>> {
    let mut all = BTreeMap::from([(path.to_owned(), Vec::new())]);
    for diagnostic in &analysis.checked.diagnostics {
        let location = diagnostic.labels.first().map(|label| label.location);
        if location.is_some_and(|location| !analysis.is_unchanged(location)) {
            continue;
        }
        let file = location.map_or(path, |location| analysis.path(location.file));
        let diagnostic = lsp_diagnostic(diagnostic, analysis, documents);
        all.entry(file.to_owned()).or_default().push(diagnostic);
    }
    all
}

pub fn lsp_diagnostic(
    diagnostic: &Diagnostic,
    analysis: &Analysis,
    documents: &Documents,
) -> LspDiagnostic {
    let mut message = visible(&diagnostic.message()).to_string();
    let mut labels = diagnostic.labels.iter();
    let first = labels.next();
    if let Some(label) = first {
        message.push_str(&format!("\n{}", visible(&label.text)));
    }
    if let Some(help) = &diagnostic.help {
        message.push_str(&format!("\nhelp: {}", visible(help)));
    }
    let related: Vec<_> = labels
        .map(|label| DiagnosticRelatedInformation {
            location: analysis.location(label.location, documents),
            message: visible(&label.text).to_string(),
        })
        .collect();
    LspDiagnostic {
        range: first.map_or_else(Range::default, |label| analysis.range(label.location)),
        severity: Some(match diagnostic.severity {
            Severity::Error => DiagnosticSeverity::Error,
            Severity::Warning => DiagnosticSeverity::Warning,
        }),
        code: Some(Code::String(diagnostic.code.name().to_owned())),
        source: Some("stochc".to_owned()),
        message: Message::String(message),
        tags: (diagnostic.code.is_unnecessary()).then(|| vec![DiagnosticTag::Unnecessary]),
        related_information: (!related.is_empty()).then_some(related),
        ..LspDiagnostic::default()
    }
}
