//! Findings, as the client shows them.
use std::collections::BTreeMap;

use gen_lsp_types::{
    Code, Diagnostic, DiagnosticRelatedInformation, DiagnosticSeverity, DiagnosticTag, Message,
    Range,
};
use stochc_compiler::finding::{Finding, Severity, visible};

use super::analysis::Analysis;
use super::documents::Documents;

/// The diagnostics of a program, by the path of their file; those of its own file always.
pub fn of(
    analysis: &Analysis,
    path: &str,
    documents: &Documents,
) -> BTreeMap<String, Vec<Diagnostic>> {
    let mut all = BTreeMap::from([(path.to_owned(), Vec::new())]);
    for finding in &analysis.checked.findings {
        let file = (finding.labels.first()).map_or(path, |label| analysis.path(label.site.file));
        let diagnostic = diagnostic(finding, analysis, documents);
        all.entry(file.to_owned()).or_default().push(diagnostic);
    }
    all
}

/// A finding.
pub fn diagnostic(finding: &Finding, analysis: &Analysis, documents: &Documents) -> Diagnostic {
    let mut message = visible(&finding.message()).to_string();
    let mut labels = finding.labels.iter();
    let first = labels.next();
    if let Some(label) = first {
        message.push_str(&format!("\n{}", visible(&label.text)));
    }
    if let Some(help) = &finding.help {
        message.push_str(&format!("\nhelp: {}", visible(help)));
    }
    let related: Vec<_> = labels
        .map(|label| DiagnosticRelatedInformation {
            location: analysis.location(label.site, documents),
            message: visible(&label.text).to_string(),
        })
        .collect();
    Diagnostic {
        range: first.map_or_else(Range::default, |label| analysis.range(label.site)),
        severity: Some(match finding.severity {
            Severity::Error => DiagnosticSeverity::Error,
            Severity::Warning => DiagnosticSeverity::Warning,
        }),
        code: Some(Code::String(finding.code.name().to_owned())),
        source: Some("stochc".to_owned()),
        message: Message::String(message),
        tags: (finding.code.is_unnecessary()).then(|| vec![DiagnosticTag::Unnecessary]),
        related_information: (!related.is_empty()).then_some(related),
        ..Diagnostic::default()
    }
}
