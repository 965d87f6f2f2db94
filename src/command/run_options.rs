//! What commands have in common that make runs of their own.
use std::path::PathBuf;

use clap::Args;

use super::show::ResultsFormat;

/// How runs are made.
#[derive(Debug, Args)]
pub struct WorkOptions {
    /// Number of runs at the same time [default: number of cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// Print no progress and no warnings
    #[arg(long, short)]
    pub quiet: bool,
}

/// The chance of runs.
#[derive(Clone, Copy, Debug, Args)]
pub struct SeedOption {
    /// Seed of the random numbers
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
}

/// What is measured by runs, and told as a table.
#[derive(Debug, Args)]
pub struct MeasuringOptions {
    #[command(flatten)]
    pub chance: SeedOption,
    /// Output format of the table
    #[arg(long, value_name = "FORM", default_value = "text")]
    pub format: ResultsFormat,
    #[command(flatten)]
    pub work: WorkOptions,
}

/// What is known of scenes.
#[derive(Debug, Args)]
pub struct RatesOption {
    /// Rates of scenes, by `stochc calibrate --out`; those of the default scene come with the program
    #[arg(long, value_name = "FILE.rates")]
    pub rates: Vec<PathBuf>,
}
