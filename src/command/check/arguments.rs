//! Arguments of `check`.
use crate::command::imports::ImportOptions;
use crate::command::levels::LevelOptions;
use crate::command::run_options::{JsonOption, count};
use crate::diagnostics::Format;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `check`.
#[derive(Debug, Args)]
pub struct CheckArguments {
    /// Programs to check, or folders with programs (`*.sa`) in them; `-` is the standard input
    #[arg(required = true, value_name = "FILE")]
    pub(super) files: Vec<String>,
    /// Output format of the diagnostics; all except `graphical` write to standard output
    #[arg(
        long,
        value_name = "FORMAT",
        default_value = "graphical",
        conflicts_with = "json"
    )]
    pub(super) format: Format,
    #[command(flatten)]
    pub(super) output: JsonOption,
    /// Print the depth, width and expected duration of each phase, and the N captures that take
    /// most of the time [default: 10]
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, default_missing_value = "10", value_parser = count)]
    pub(super) cost: Option<usize>,
    /// Rates of scenes for `--cost`, written by `stochc calibrate`; other scenes are estimated
    #[arg(long, value_name = "FILE.rates", requires = "cost")]
    pub(super) rates: Vec<PathBuf>,
    /// List the physics of the scenes: each term with its equation and value, the terms left out, dimensionless numbers, and the
    /// error of the time step
    #[arg(long)]
    pub(super) physics: bool,
    /// Apply all safe fixes and show them as a diff
    #[arg(long)]
    pub(super) fix: bool,
    /// Show the changes of `--fix` without writing them
    #[arg(long, requires = "fix")]
    pub(super) dry_run: bool,
    #[command(flatten)]
    pub(super) levels: LevelOptions,
    #[command(flatten)]
    pub(super) imports: ImportOptions,
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
