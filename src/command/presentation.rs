//! Options for units and program names in tables and figures.
use clap::{Args, ValueEnum};
use stochc_report::presentation::{Presentation, ProgramLabel};

/// Unit of times, and labels of programs.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub struct PresentationOptions {
    /// Unit of times in figures, and in tables for documents (CSV, LaTeX, Markdown)
    #[arg(long, value_name = "UNIT", default_value = "ticks")]
    unit: UnitOption,
    /// Text to show instead of the name of a program, such as `tower=Tower of five`. Can be repeated
    #[arg(long, value_name = "NAME=TEXT")]
    label: Vec<ProgramLabel>,
}

/// Unit of times.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum UnitOption {
    /// Ticks of the scene. If programs have ticks of different lengths, times are in seconds
    Ticks,
    /// Seconds of simulated time
    S,
}

impl PresentationOptions {
    /// Returns the names of programs and the unit of times that the options choose.
    pub fn presentation(&self) -> Presentation {
        Presentation {
            in_seconds: self.unit == UnitOption::S,
            labels: self.label.clone(),
        }
    }
}
