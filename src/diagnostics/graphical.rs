//! Diagnostics that are drawn over the source.
use stochc_compiler::diagnostic::{Code, Diagnostic, Edit, Renderer, Severity};
use stochc_compiler::{Checked, FileId};
use stochc_text::{counted, series};

/// Largest number of drawn diagnostics. Further diagnostics are only counted.
const MAX_DRAWN: usize = 50;

/// Largest number of diagnostic codes in the last line.
const MAX_NAMED: usize = 5;

/// Returns all diagnostics of a file, drawn over the source, errors first.
pub fn show(checked: &Checked, colour: bool, width: usize) -> String {
    draw(checked, |_| true, colour, width)
}

/// Returns the errors of a file, drawn over the source.
pub fn show_errors(checked: &Checked, colour: bool, width: usize) -> String {
    draw(checked, Diagnostic::is_error, colour, width)
}

fn draw(
    checked: &Checked,
    is_drawn: impl Fn(&Diagnostic) -> bool,
    colour: bool,
    width: usize,
) -> String {
    let renderer = Renderer::new(colour, width);
    let mut out = String::new();
    let drawn = || checked.diagnostics.iter().filter(|it| is_drawn(it));
    for diagnostic in drawn().take(MAX_DRAWN) {
        out.push_str(&renderer.render(diagnostic, &checked.sources));
        out.push('\n');
    }
    let rest = drawn().skip(MAX_DRAWN).count();
    if rest > 0 {
        let diagnostics = counted(rest, "more diagnostic");
        let file = stochc_text::visible(&checked.sources.file(FileId(0)).name);
        out.push_str(&format!(
            "{diagnostics} in {file}; `--format short` shows all of them\n\n"
        ));
    }
    out
}

/// Counts and codes of diagnostics, for the last lines of the output.
#[derive(Clone, Debug, Default)]
pub struct DiagnosticCounts {
    errors: usize,
    warnings: usize,
    fixable: usize,
    /// Codes of the counted diagnostics without duplicates, errors first.
    codes: Vec<(Severity, Code)>,
}

impl DiagnosticCounts {
    /// Counts the diagnostics of a file.
    pub fn add(&mut self, checked: &Checked) {
        for diagnostic in &checked.diagnostics {
            match diagnostic.severity {
                Severity::Error => self.errors += 1,
                Severity::Warning => self.warnings += 1,
            }
            if !self.codes.iter().any(|&(_, code)| code == diagnostic.code) {
                self.codes.push((diagnostic.severity, diagnostic.code));
            }
            // A check of another file applies the fixes of that file.
            let is_own = |edit: &Edit| edit.location.file == FileId(0);
            let fix = diagnostic.fix.as_ref();
            let is_fixable = fix.is_some_and(|fix| fix.safe && fix.edits.iter().all(is_own));
            self.fixable += usize::from(is_fixable);
        }
        self.codes.sort_by_key(|&(severity, _)| severity);
    }

    /// Returns the last lines, such as ``2 errors, 1 warning; `stochc check --fix` can fix 1 of
    /// them``, and a line about `stochc explain`. Returns an empty text if nothing was counted.
    pub fn lines(&self) -> String {
        let parts = [(self.errors, "error"), (self.warnings, "warning")];
        let counts: Vec<String> = (parts.into_iter())
            .filter(|&(number, _)| number > 0)
            .map(|(number, noun)| counted(number, noun))
            .collect();
        if counts.is_empty() {
            return String::new();
        }
        let all = self.errors + self.warnings;
        let fixable = match self.fixable {
            0 => String::new(),
            _ if all == 1 => "; `stochc check --fix` can fix it".to_owned(),
            some if some == all => "; `stochc check --fix` can fix them all".to_owned(),
            some => format!("; `stochc check --fix` can fix {some} of them"),
        };
        format!("{}{fixable}\n{}\n", counts.join(", "), self.explain_line())
    }

    fn explain_line(&self) -> String {
        let codes: Vec<&str> = self.codes.iter().map(|(_, code)| code.name()).collect();
        match &codes[..] {
            [only] => format!("For an explanation, run `stochc explain {only}`."),
            codes => {
                let named = series(&codes[..codes.len().min(MAX_NAMED)], "or");
                format!("For explanations, run `stochc explain CODE` with {named}.")
            }
        }
    }
}
