//! What the compiler has to say about a program.
mod change;
mod code;
mod fix;
mod graphical;
mod parameter_hint;
mod repeat;
mod row_hint;
mod syntax;
mod syntax_hints;

pub use change::TextChange;
pub use code::{Code, Severity};
pub(crate) use fix::{LONG, entry, last_named, named, removal};
pub use graphical::{Renderer, visible};
pub(crate) use parameter_hint::parameter_hint;
pub use repeat::Others;
pub(crate) use row_hint::row_hint;

use crate::{FileId, SourceLocation};
use stochc_ir::suggest::{Suggestion, nearest};

/// One message, with the places it speaks of.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Its kind; what `stochc explain` takes.
    pub code: Code,
    /// How bad it is: as its kind is, unless the file or the command line denies a warning.
    pub severity: Severity,
    /// The message, in one line.
    pub title: String,
    /// The places, the one to look at first at the front; empty only if there is no text to show.
    pub labels: Vec<Label>,
    /// What to do next.
    pub help: Option<String>,
    /// The part of `help` that others, told as one with this finding, may need otherwise.
    pub(crate) remedy: Option<String>,
    /// A change of the text that fixes it.
    pub fix: Option<Fix>,
    /// The same, said of others: of the other rounds of a loop.
    pub others: Others,
    /// The programs that it is about, by their places in [`Checked::programs`](crate::Checked::programs), in order;
    /// none for what is about the file.
    pub programs: Vec<usize>,
}

/// A change of the text that fixes a finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// What it does, as a command: `add an \`after\``.
    pub title: String,
    /// The changes, which do not overlap.
    pub edits: Vec<Edit>,
    /// Whether the program surely means the same afterwards, or is right where it was wrong in one
    /// way only; what is not safe is shown, and never applied unasked.
    pub safe: bool,
}

/// A piece of text that takes the place of another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    /// What goes; empty: an insertion.
    pub location: SourceLocation,
    /// What comes.
    pub text: String,
}

/// A place with its part in the message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// Where.
    pub location: SourceLocation,
    /// What is there.
    pub text: String,
}

/// Errors of one assembly that are told, at most, and as many warnings.
const MAX_FINDINGS: usize = 1_000;

/// Whether so many findings of this severity are told that no more are, which has been told as well.
pub(crate) fn is_full(diagnostics: &[Diagnostic], severity: Severity) -> bool {
    let note = too_many(severity);
    let mut last_first = diagnostics.iter().rev();
    diagnostics.len() > MAX_FINDINGS && last_first.any(|it| it.code == note)
}

/// Whether there are as many errors as are told.
pub(crate) fn has_enough_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.len() >= MAX_FINDINGS && count(diagnostics, Severity::Error) >= MAX_FINDINGS
}

/// What says that there are more findings of this severity.
fn too_many(severity: Severity) -> Code {
    match severity {
        Severity::Error => Code::TooManyErrors,
        Severity::Warning => Code::TooManyWarnings,
    }
}

/// How many findings have this severity.
fn count(diagnostics: &[Diagnostic], severity: Severity) -> usize {
    let codes = diagnostics.iter().map(|diagnostic| diagnostic.code);
    codes.filter(|code| code.severity() == severity).count()
}

/// Findings among which words are looked for that unknown ones may be meant to be: that takes time, again whenever a fix is
/// tried, and whoever has more of them fixes the first ones and checks again.
const MAX_MEANT: usize = 200;

/// Returns the known word that is closest to an unknown one. Returns `None` after [`MAX_MEANT`] diagnostics.
pub(crate) fn meant<S: AsRef<str>>(
    diagnostics: &[Diagnostic],
    unknown: &str,
    known: impl IntoIterator<Item = S>,
) -> Option<Suggestion> {
    let is_asked = diagnostics.len() < MAX_MEANT;
    is_asked.then(|| nearest(unknown, known)).flatten()
}

/// Adds a finding, unless one like it has been told of the same place, or there are so many of its severity that
/// nobody would read them.
pub(crate) fn report(diagnostics: &mut Vec<Diagnostic>, diagnostic: Diagnostic) {
    let severity = diagnostic.code.severity();
    if is_full(diagnostics, severity) || is_repeated(diagnostics, &diagnostic) {
        return;
    }
    if diagnostics.len() < MAX_FINDINGS || count(diagnostics, severity) < MAX_FINDINGS {
        diagnostics.push(diagnostic);
        return;
    }
    let what = match severity {
        Severity::Error => "errors",
        Severity::Warning => "warnings",
    };
    let title = format!("more than {MAX_FINDINGS} {what}; the rest is not told");
    let labels = diagnostic.labels.into_iter().take(1);
    let mut last =
        Diagnostic::new(too_many(severity), title).help("fix the first few and check again");
    last.labels.extend(labels);
    diagnostics.push(last);
}

/// Whether a finding only says of something else what one of `diagnostics` says at the same place,
/// which has taken it in then.
pub(crate) fn is_repeated(diagnostics: &mut [Diagnostic], diagnostic: &Diagnostic) -> bool {
    let mut last_first = diagnostics.iter_mut().rev();
    last_first.any(|told| told.absorb(diagnostic))
}

/// Has each of the findings, which are in the order of their places, take in what only repeats it.
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

impl Diagnostic {
    /// A finding without labels or help.
    pub fn new(code: Code, title: impl Into<String>) -> Diagnostic {
        Diagnostic {
            code,
            severity: code.severity(),
            title: title.into(),
            labels: Vec::new(),
            help: None,
            remedy: None,
            fix: None,
            others: Others::default(),
            programs: Vec::new(),
        }
    }

    /// The file and the byte to look at first; `None` if there is no text to show.
    pub(crate) fn place(&self) -> Option<(FileId, u32)> {
        let location = self.labels.first()?.location;
        Some((location.file, location.span.start))
    }

    /// What it says, in one line: the title, and for what else it holds.
    pub fn message(&self) -> String {
        format!("{}{}", self.title, self.others.text())
    }

    /// Adds a place.
    #[must_use]
    pub fn label(mut self, location: SourceLocation, text: impl Into<String>) -> Diagnostic {
        self.labels.push(Label {
            location,
            text: text.into(),
        });
        self
    }

    /// Says what to do next.
    #[must_use]
    pub fn help(mut self, text: impl Into<String>) -> Diagnostic {
        self.help = Some(text.into());
        self
    }

    /// Says how the text can be fixed.
    #[must_use]
    pub fn fix(mut self, fix: Fix) -> Diagnostic {
        self.fix = Some(fix);
        self
    }

    /// Says how the text can be fixed, if that is known.
    #[must_use]
    pub(crate) fn fix_if(mut self, fix: Option<Fix>) -> Diagnostic {
        self.fix = fix;
        self
    }

    /// Says which known word the one at `location` is probably meant to be, or else what to do.
    #[must_use]
    pub(crate) fn suggest(
        mut self,
        location: SourceLocation,
        meant: Option<Suggestion>,
        otherwise: impl FnOnce() -> String,
    ) -> Diagnostic {
        let Some(meant) = meant else {
            return self.help(otherwise());
        };
        self.fix = Some(Fix::word(location, &meant));
        self.help(meant.help())
    }

    /// Whether it is a warning that counts as an error.
    pub(crate) fn is_denied(&self) -> bool {
        self.is_error() && self.code.severity() == Severity::Warning
    }

    /// Whether the program is wrong, not merely suspicious.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}
