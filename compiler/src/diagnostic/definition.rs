//! A diagnostic with its labels and its fix.
use stochc_text::suggest::Suggestion;

use super::code::{Code, Severity};
use super::subjects::{Others, Subjects};
use crate::{FileId, SourceLocation};

/// An error or warning with its source locations.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Kind of the diagnostic. `stochc explain` explains it.
    pub code: Code,
    /// Severity: an error if the code is an error, or if the file or the command line denies the
    /// warning.
    pub severity: Severity,
    /// Message in one line. Names the wrong part of the program.
    pub title: String,
    /// Labelled locations, the most important first. Empty only if no source can be shown.
    pub labels: Vec<Label>,
    /// Advice, with a patch if possible.
    pub help: Option<String>,
    /// Part of `help` that may differ between merged diagnostics.
    pub(crate) remedy: Option<String>,
    /// Change of the source that fixes the error.
    pub fix: Option<Fix>,
    /// Format and subjects of the title. `None` if the diagnostic is never merged.
    pub(crate) subjects: Option<Subjects>,
    /// Merged diagnostics, such as the same diagnostic in other rounds of a loop.
    pub others: Others,
    /// Indices of the affected programs in [`Checked::programs`](crate::Checked::programs), in
    /// rising order. Empty if the diagnostic is about the file.
    pub programs: Vec<usize>,
}

/// Change of the source that fixes a diagnostic.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// Action in the imperative: ``add an `after` ``.
    pub title: String,
    /// Changes that do not overlap.
    pub edits: Vec<Edit>,
    /// Whether `check --fix` may apply the fix. Safe fixes keep the meaning, or are the only way to
    /// correct the program.
    pub safe: bool,
}

/// Replacement of a part of the source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    /// Source that is replaced. Empty for an insertion.
    pub location: SourceLocation,
    /// New text.
    pub text: String,
}

/// A location with a statement about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// Location in the source.
    pub location: SourceLocation,
    /// Statement about the location.
    pub text: String,
}

impl Diagnostic {
    /// Returns a diagnostic without labels and help.
    pub fn new(code: Code, title: impl Into<String>) -> Diagnostic {
        Diagnostic {
            code,
            severity: code.severity(),
            title: title.into(),
            labels: Vec::new(),
            help: None,
            remedy: None,
            fix: None,
            subjects: None,
            others: Others::default(),
            programs: Vec::new(),
        }
    }

    /// Creates a diagnostic whose title is `format` with `subjects` replacing each `{}`.
    ///
    /// Diagnostics with the same location and format are merged. The title of the first one is
    /// shown, then the other subjects.
    pub(crate) fn about(code: Code, format: &'static str, subjects: &[&str]) -> Diagnostic {
        let subjects = Subjects::new(format, subjects);
        Diagnostic {
            subjects: Some(subjects.clone()),
            ..Diagnostic::new(code, subjects.title())
        }
    }

    /// Returns the file and the byte of the first label. Returns `None` if no source can be shown.
    pub(crate) fn place(&self) -> Option<(FileId, u32)> {
        let location = self.labels.first()?.location;
        Some((location.file, location.span.start))
    }

    /// Returns the title, with the subjects of merged diagnostics.
    pub fn message(&self) -> String {
        format!("{}{}", self.title, self.others.text())
    }

    /// Adds a label: a location with a statement about it.
    #[must_use]
    pub fn label(mut self, location: SourceLocation, text: impl Into<String>) -> Diagnostic {
        self.labels.push(Label {
            location,
            text: text.into(),
        });
        self
    }

    /// Sets the advice.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Diagnostic {
        self.help = Some(text.into());
        self
    }

    /// Sets the fix.
    #[must_use]
    pub fn fix(mut self, fix: Fix) -> Diagnostic {
        self.fix = Some(fix);
        self
    }

    #[must_use]
    pub(crate) fn fix_if(mut self, fix: Option<Fix>) -> Diagnostic {
        self.fix = fix;
        self
    }

    /// Suggests the known word that is closest to the one at `location`, or else sets the help.
    #[must_use]
    pub(crate) fn suggest(
        mut self,
        location: SourceLocation,
        suggestion: Option<Suggestion>,
        otherwise: impl FnOnce() -> String,
    ) -> Diagnostic {
        let Some(suggestion) = suggestion else {
            return self.help(otherwise());
        };
        self.fix = Some(Fix::word(location, &suggestion));
        self.help(suggestion.help())
    }

    /// Returns whether the diagnostic is a warning that counts as an error.
    pub(crate) fn is_denied(&self) -> bool {
        self.is_error() && self.code.severity() == Severity::Warning
    }

    /// Returns whether the diagnostic is an error.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}
