//! Arguments of `check`.
use crate::command::run_options::{JsonOption, count};
use crate::command::source_options::SourceOptions;
use crate::diagnostics::Format;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct CheckArguments {
    /// Programs to check, or folders that contain programs (`*.sa`). `-` checks the standard input
    #[arg(required = true, value_name = "FILE")]
    pub(super) files: Vec<String>,
    /// Format of errors and warnings. All formats except `graphical` are written to the standard output
    #[arg(
        long,
        value_name = "FORMAT",
        default_value = "graphical",
        conflicts_with = "json"
    )]
    pub(super) format: Format,
    #[command(flatten)]
    pub(super) output: JsonOption,
    /// Print the expected duration of each phase, and the N captures that take most of the time. N is 10 if it is not given
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, default_missing_value = "10", value_parser = count)]
    pub(super) cost: Option<usize>,
    /// File with the rates of a scene for `--cost`, written by `stochc calibrate`. Without rates, the cost is a rougher
    /// estimate
    #[arg(long, value_name = "FILE.rates", requires = "cost")]
    pub(super) rates: Vec<PathBuf>,
    /// Print the physics of the scene: each term with its equation and value, and the terms that the scene does not have.
    /// Also print its dimensionless numbers and the error of the time step
    #[arg(long)]
    pub(super) physics: bool,
    /// Apply all safe fixes to the files, and show the changes
    #[arg(long)]
    pub(super) fix: bool,
    /// Show the changes of `--fix` without writing them
    #[arg(long, requires = "fix")]
    pub(super) dry_run: bool,
    #[command(flatten)]
    pub(super) source: SourceOptions,
}

impl CheckArguments {
    pub(super) fn format(&self) -> Format {
        if self.output.json {
            Format::Json
        } else {
            self.format
        }
    }
}
