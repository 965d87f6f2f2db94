//! Options that several commands share.
use std::path::PathBuf;

use clap::Args;

/// Number of runs at the same time.
#[derive(Debug, Args)]
#[command(next_help_heading = "Runs")]
pub struct ThreadsOption {
    /// Number of runs that are computed at the same time [default: number of cores]
    #[arg(long, short = 'j', value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
}

/// Seed of the random numbers.
#[derive(Clone, Copy, Debug, Args)]
#[command(next_help_heading = "Runs")]
pub struct SeedOption {
    /// Seed of the random numbers. The same seed gives the same runs
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
}

/// The output format of commands that print text or JSON.
#[derive(Clone, Copy, Debug, Args)]
#[command(next_help_heading = "Output")]
pub struct JsonOption {
    /// Print the output as JSON
    #[arg(long)]
    pub json: bool,
}

/// Options of commands that simulate runs to measure something, and that print a table.
#[derive(Debug, Args)]
pub struct MeasuringOptions {
    #[command(flatten)]
    pub chance: SeedOption,
    #[command(flatten)]
    pub work: ThreadsOption,
    #[command(flatten)]
    pub output: JsonOption,
}

/// Options of the printed results of an ensemble.
#[derive(Clone, Copy, Debug, Args)]
#[command(next_help_heading = "Output")]
pub struct ResultsOptions {
    /// Also list the captures with their waiting times. With N, list only the N slowest captures
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, default_missing_value = ALL, value_parser = count)]
    pub captures: Option<usize>,
    #[command(flatten)]
    pub output: JsonOption,
}

/// Calibrated rates of scenes.
#[derive(Debug, Args)]
pub struct RatesOption {
    /// File with the rates of a scene, written by `stochc calibrate`. Rates of the default scene are built in
    #[arg(long, value_name = "FILE.rates")]
    pub rates: Vec<PathBuf>,
}

/// Value of an option that stands for all captures.
pub const ALL: &str = "all";

/// Parses a number of captures. Returns the largest possible number for [`ALL`].
pub fn count(text: &str) -> Result<usize, String> {
    if text == ALL {
        return Ok(usize::MAX);
    }
    let number = text.parse().ok().filter(|&number: &usize| number > 0);
    number.ok_or_else(|| "give a whole number from 1".to_owned())
}
