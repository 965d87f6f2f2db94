//! Collects diagnostics up to a limit.
use stochc_text::suggest::{Suggestion, nearest};

use super::code::{Code, Severity};
use super::definition::Diagnostic;

/// Largest number of reported errors of an assembly. The same limit applies to warnings.
const MAX_DIAGNOSTICS: usize = 1_000;

/// Returns whether the limit of diagnostics of this severity is reached and reported.
pub(crate) fn is_full(diagnostics: &[Diagnostic], severity: Severity) -> bool {
    let note = too_many(severity);
    let mut last_first = diagnostics.iter().rev();
    diagnostics.len() > MAX_DIAGNOSTICS && last_first.any(|it| it.code == note)
}

/// Returns whether the limit of errors is reached.
pub(crate) fn has_enough_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.len() >= MAX_DIAGNOSTICS && count(diagnostics, Severity::Error) >= MAX_DIAGNOSTICS
}

/// Returns the code that reports that the limit of a severity is reached.
fn too_many(severity: Severity) -> Code {
    match severity {
        Severity::Error => Code::TooManyErrors,
        Severity::Warning => Code::TooManyWarnings,
    }
}

pub(super) fn count(diagnostics: &[Diagnostic], severity: Severity) -> usize {
    let codes = diagnostics.iter().map(|diagnostic| diagnostic.code);
    codes.filter(|code| code.severity() == severity).count()
}

/// Largest number of diagnostics with a search for similar names. The search is slow and runs again
/// for every fix.
const MAX_SUGGESTIONS: usize = 200;

/// Returns the known word that is closest to an unknown one. Returns `None` after
/// [`MAX_SUGGESTIONS`] diagnostics.
pub(crate) fn suggestion<S: AsRef<str>>(
    diagnostics: &[Diagnostic],
    unknown: &str,
    known: impl IntoIterator<Item = S>,
) -> Option<Suggestion> {
    let is_asked = diagnostics.len() < MAX_SUGGESTIONS;
    is_asked.then(|| nearest(unknown, known)).flatten()
}

/// Adds a diagnostic, or merges it into one at the same location. Ignores it if the limit of its
/// severity is reached.
pub(crate) fn report(diagnostics: &mut Vec<Diagnostic>, diagnostic: Diagnostic) {
    let severity = diagnostic.code.severity();
    if is_full(diagnostics, severity) || is_repeated(diagnostics, &diagnostic) {
        return;
    }
    if diagnostics.len() < MAX_DIAGNOSTICS || count(diagnostics, severity) < MAX_DIAGNOSTICS {
        diagnostics.push(diagnostic);
        return;
    }
    let what = match severity {
        Severity::Error => "errors",
        Severity::Warning => "warnings",
    };
    let title = format!("more than {MAX_DIAGNOSTICS} {what}; the others are not shown");
    let labels = diagnostic.labels.into_iter().take(1);
    let mut last =
        Diagnostic::new(too_many(severity), title).help("fix the first ones and check again");
    last.labels.extend(labels);
    diagnostics.push(last);
}

/// Merges a diagnostic into one of `diagnostics` if possible. Returns whether it was merged.
pub(crate) fn is_repeated(diagnostics: &mut [Diagnostic], diagnostic: &Diagnostic) -> bool {
    let mut last_first = diagnostics.iter_mut().rev();
    last_first.any(|earlier| earlier.absorb(diagnostic))
}

/// Merges diagnostics of one statement. `diagnostics` are sorted by location.
pub(crate) fn fold(diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let mut folded: Vec<Diagnostic> = Vec::new();
    let mut of_place = 0;
    for diagnostic in diagnostics {
        if folded.last().map(Diagnostic::place) != Some(diagnostic.place()) {
            of_place = folded.len();
        }
        if !is_repeated(&mut folded[of_place..], &diagnostic) {
            folded.push(diagnostic);
        }
    }
    folded
}
