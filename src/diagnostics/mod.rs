//! Output of diagnostics: drawn, as single lines, as JSON, or as SARIF.
mod graphical;
mod json;
mod sarif;
mod short;

use stochc_compiler::Checked;

pub use graphical::DiagnosticCounts;
pub use json::CheckDocument;
pub use sarif::SarifLog;
pub use short::warning_lines;
pub use stochc_compiler::diagnostic::diagnostics_json;

/// Output format of diagnostics.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "command", derive(clap::ValueEnum))]
pub enum Format {
    /// Diagnostics drawn over the source text.
    Graphical,
    /// One line per diagnostic: `file:line:column: severity[code]: message`.
    Short,
    /// One JSON document.
    Json,
    /// One SARIF 2.1.0 document, for code review.
    Sarif,
}

/// Returns the diagnostics of a file in this format.
pub fn show(checked: &Checked, format: Format, colour: bool, width: usize) -> String {
    match format {
        Format::Graphical => graphical::show(checked, colour, width),
        Format::Short => short::show(checked),
        Format::Json => {
            let mut document = CheckDocument::default();
            let root = checked.sources.files().first();
            let name = root.map_or("", |file| &file.name);
            document.add(name, checked, "", |_| None);
            document.text()
        }
        Format::Sarif => {
            let mut log = SarifLog::new(None);
            log.add("", checked);
            log.document()
        }
    }
}

/// Returns the diagnostics of one file, drawn over its source. The last line states the number of
/// diagnostics.
pub fn drawn(checked: &Checked, colour: bool, width: usize) -> String {
    let mut tally = DiagnosticCounts::default();
    tally.add(checked);
    graphical::show(checked, colour, width) + &tally.lines()
}

/// Returns the errors of one file, drawn over its source. The last line states the number of
/// diagnostics.
pub fn drawn_errors(checked: &Checked, colour: bool, width: usize) -> String {
    let mut tally = DiagnosticCounts::default();
    tally.add(checked);
    graphical::show_errors(checked, colour, width) + &tally.lines()
}
