//! Code actions that fix diagnostics.
use std::collections::HashMap;
use std::ops::Range;

use gen_lsp_types::{CodeAction, CodeActionKind, TextEdit, Uri, WorkspaceEdit};
use stochc_compiler::diagnostic::{Diagnostic, Fix};

use super::diagnostics::lsp_diagnostic;
use crate::workspace::analysis::Analysis;
use crate::workspace::documents::Documents;

/// Returns the fixes of diagnostics in a range of bytes of a program's file. Excludes fixes that an
/// edit after the analysis may have made wrong.
pub fn actions(
    analysis: &Analysis,
    path: &str,
    within: &Range<usize>,
    documents: &Documents,
) -> Vec<CodeAction> {
    let file = analysis.file(path);
    let is_near = |diagnostic: &&Diagnostic| {
        diagnostic.labels.iter().any(|label| {
            let span = label.location.span;
            Some(label.location.file) == file
                && (span.start as usize) < within.end
                && within.start <= span.end as usize
        })
    };
    let diagnostics = analysis.checked.diagnostics.iter().filter(is_near);
    diagnostics
        .filter_map(|diagnostic| Some((diagnostic, diagnostic.fix.as_ref()?)))
        .filter(|(_, fix)| {
            let mut edits = fix.edits.iter();
            !analysis.has_old_imports && edits.all(|edit| analysis.is_unchanged(edit.location))
        })
        .map(|(diagnostic, fix)| CodeAction {
            title: fix.title.clone(),
            kind: Some(CodeActionKind::QuickFix),
            diagnostics: Some(vec![lsp_diagnostic(diagnostic, analysis, documents)]),
            is_preferred: Some(fix.safe),
            edit: Some(edit(fix, analysis, documents)),
            ..CodeAction::default()
        })
        .collect()
}

fn edit(fix: &Fix, analysis: &Analysis, documents: &Documents) -> WorkspaceEdit {
    let mut changes: HashMap<Uri, Vec<TextEdit>> = HashMap::new();
    for edit in &fix.edits {
        let uri = documents.uri(analysis.path(edit.location.file));
        changes.entry(uri.into()).or_default().push(TextEdit {
            range: analysis.range(edit.location),
            new_text: edit.text.clone(),
        });
    }
    WorkspaceEdit {
        changes: Some(changes),
        ..WorkspaceEdit::default()
    }
}

#[cfg(test)]
mod tests {
    use stochc_compiler::diagnostic::{Code, Edit};
    use stochc_compiler::{Cancellation, SourceLocation, Span};

    use super::*;
    use crate::workspace::position::Encoding;

    #[test]
    fn a_fix_is_offered_at_its_diagnostic() {
        let documents = Documents::default();
        let text = "let \u{b5} = 1\nlet n = 2\n";
        let path = documents.open("file:///x/a.sa".to_owned(), text.to_owned(), 1);
        let mut reader = |path: &str| documents.read(path, Encoding::Utf16);
        let never = Cancellation::NEVER;
        let analysis = Analysis::new(&path, &mut reader, Encoding::Utf16, never);
        let mut analysis = analysis.unwrap();
        let at = |start, end| SourceLocation {
            file: stochc_compiler::FileId(0),
            span: Span::new(start, end),
        };
        let fix = Fix {
            title: "call it `m`".to_owned(),
            edits: vec![Edit {
                location: at(15, 16),
                text: "m".to_owned(),
            }],
            safe: true,
        };
        let diagnostic = Diagnostic::new(Code::UnknownName, "a name").label(at(15, 16), "here");
        let checked = std::sync::Arc::get_mut(&mut analysis.checked).unwrap();
        checked.diagnostics = vec![diagnostic.clone().fix(fix), diagnostic];

        let found = actions(&analysis, &path, &(15..16), &documents);
        assert_eq!(found.len(), 1);
        let action = serde_json::to_value(&found[0]).unwrap();
        assert_eq!(action["title"], "call it `m`");
        assert_eq!(action["isPreferred"], true);
        let edit = &action["edit"]["changes"]["file:///x/a.sa"][0];
        assert_eq!(edit["newText"], "m");
        assert_eq!(edit["range"]["start"]["line"], 1);
        assert_eq!(edit["range"]["start"]["character"], 4);
        assert_eq!(actions(&analysis, &path, &(0..4), &documents), []);
    }
}
