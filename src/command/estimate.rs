//! `stochc estimate`.
use std::path::PathBuf;

use clap::Args;
use stochc_ensemble::MOST_RUNS;
use stochc_report::tables::estimates_to_text;

use super::imports::ImportOptions;
use super::interrupt::stop_on_interrupt;
use super::levels::LevelOptions;
use super::results::ResultsFormat;
use super::terminal::{Terminal, output_width, print};
use crate::exit::{Exit, Failure};
use crate::operations::estimate::{Estimating, estimates};
use crate::operations::programs::programs;

/// What `estimate` is given.
#[derive(Debug, Args)]
pub struct Options {
    /// Programs, or files of compiled ones
    #[arg(value_name = "FILE", required = true)]
    files: Vec<String>,
    /// Rates of scenes, by `stochc calibrate --out`; scenes that no file is about are measured first
    #[arg(long, value_name = "FILE.rates")]
    rates: Vec<PathBuf>,
    /// Runs by rates of each program [default: 2000, fewer for large programs, so that a million captures are drawn]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=MOST_RUNS))]
    runs: Option<u64>,
    /// Show so many of the captures that decide the time
    #[arg(long, value_name = "N", default_value_t = 5)]
    captures: usize,
    /// Stop a run after this many ticks
    #[arg(long, default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..))]
    max_ticks: u64,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
    /// Number of runs at the same time [default: number of cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Output format
    #[arg(long, value_name = "FORM", default_value = "text")]
    format: ResultsFormat,
    /// Do not show progress
    #[arg(long, short)]
    quiet: bool,
    /// What becomes of warnings
    #[command(flatten)]
    levels: LevelOptions,
    #[command(flatten)]
    imports: ImportOptions,
}

/// Says when programs will be complete, by rates.
pub fn run(options: &Options) -> Result<Exit, Failure> {
    let host = Terminal::new(options.quiet);
    let (levels, imports) = (&options.levels.levels, &options.imports.folders);
    let programs = programs(&options.files, levels, imports, &host)?;
    stop_on_interrupt()?;
    let how = Estimating {
        rates: &options.rates,
        runs: options.runs,
        max_ticks: options.max_ticks,
        seed: options.seed,
        threads: options.threads,
    };
    let estimates = estimates(programs, &how, &host)?;
    match options.format {
        ResultsFormat::Text => print(&estimates_to_text(
            &estimates,
            options.captures,
            output_width(),
        ))?,
        ResultsFormat::Json => {
            let text = serde_json::to_string_pretty(&estimates).expect("estimates are plain data");
            print(&(text + "\n"))?;
        }
    }
    Ok(
        match estimates.iter().all(|estimate| estimate.total.is_some()) {
            true => Exit::Success,
            false => Exit::UnsuccessfulRun,
        },
    )
}
