//! Findings drawn over the text.
use stochc_compiler::diagnostic::{Diagnostic, Edit, Renderer, Severity};
use stochc_compiler::{Checked, FileId};
use stochc_ir::counted;

/// Findings that are drawn at most; the rest are counted.
const MAX_DRAWN: usize = 50;

/// Draws all diagnostics of a file, errors first.
pub fn show(checked: &Checked, colour: bool, width: usize) -> String {
    draw(checked, |_| true, colour, width)
}

/// Draws the errors of a file alone.
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
        let diagnostics = counted(rest, "more finding");
        let file = stochc_ir::visible(&checked.sources.file(FileId(0)).name);
        out.push_str(&format!(
            "{diagnostics} in {file}; `--format short` shows all of them\n\n"
        ));
    }
    out
}

/// How many findings there are, for a last line.
#[derive(Clone, Copy, Debug, Default)]
pub struct FindingCounts {
    errors: usize,
    warnings: usize,
    fixable: usize,
}

impl FindingCounts {
    /// Counts those of a file, too.
    pub fn add(&mut self, checked: &Checked) {
        for diagnostic in &checked.diagnostics {
            match diagnostic.severity {
                Severity::Error => self.errors += 1,
                Severity::Warning => self.warnings += 1,
            }
            // What another file needs is done there.
            let is_own = |edit: &Edit| edit.location.file == FileId(0);
            let fix = diagnostic.fix.as_ref();
            let is_fixable = fix.is_some_and(|fix| fix.safe && fix.edits.iter().all(is_own));
            self.fixable += usize::from(is_fixable);
        }
    }

    /// ``2 errors, 1 warning; `stochc check --fix` can fix 1 of them``; empty if there is nothing to
    /// count.
    pub fn line(&self) -> String {
        let parts = [(self.errors, "error"), (self.warnings, "warning")];
        let told: Vec<String> = (parts.into_iter())
            .filter(|&(number, _)| number > 0)
            .map(|(number, noun)| counted(number, noun))
            .collect();
        let all = self.errors + self.warnings;
        let fixable = match self.fixable {
            0 => String::new(),
            _ if all == 1 => "; `stochc check --fix` can fix it".to_owned(),
            some if some == all => "; `stochc check --fix` can fix them all".to_owned(),
            some => format!("; `stochc check --fix` can fix {some} of them"),
        };
        if told.is_empty() {
            String::new()
        } else {
            format!("{}{fixable}\n", told.join(", "))
        }
    }
}
