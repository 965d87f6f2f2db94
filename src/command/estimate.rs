//! `stochc estimate`.
use std::path::PathBuf;

use clap::Args;
use stochc_ensemble::{MOST_RUNS, Manifest, Program};
use stochc_report::estimate::Estimate;
use stochc_report::tables::estimates_to_text;
use stochc_runtime::{Model, Settings};

use super::imports::ImportOptions;
use super::in_memory::all_runs;
use super::interrupt::stop_on_interrupt;
use super::levels::LevelOptions;
use super::results::Form;
use super::simulate::{programs, rates_of_scenes};
use super::terminal::{output_width, print};
use crate::exit::{Exit, Failure};

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
    format: Form,
    /// Do not show progress
    #[arg(long, short)]
    quiet: bool,
    /// What becomes of warnings
    #[command(flatten)]
    levels: LevelOptions,
    #[command(flatten)]
    imports: ImportOptions,
}

/// Captures that are drawn of a program in all of its runs, about.
const DRAWN: u64 = 1_000_000;

/// Runs of a program, at most and at least.
const MOST: u64 = 2000;
const LEAST: u64 = 20;

/// Says when programs will be complete, by rates.
pub fn run(options: &Options) -> Result<Exit, Failure> {
    let programs = programs(&options.files, &options.levels.levels, &options.imports)?;
    let stop = stop_on_interrupt()?;
    let rates = rates_of_scenes(
        &options.rates,
        &programs,
        (options.threads, options.quiet),
        stop,
    )?;
    let settings = Settings {
        rates,
        max_ticks: Some(options.max_ticks),
        ..Settings::of(Model::Rate, 1)
    };
    let mut estimates = Vec::new();
    for program in programs {
        let runs = (options.runs).unwrap_or((DRAWN / program.captures().max(1)).clamp(LEAST, MOST));
        let settings = settings.clone();
        estimates.push(estimate(options, settings, runs, program, stop)?);
    }
    match options.format {
        Form::Text => print(&estimates_to_text(
            &estimates,
            options.captures,
            output_width(),
        ))?,
        Form::Json => {
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

fn estimate(
    options: &Options,
    settings: Settings,
    runs: u64,
    program: Program,
    stop: &std::sync::atomic::AtomicBool,
) -> Result<Estimate, Failure> {
    let manifest = Manifest::new(settings, options.seed, runs, vec![program]);
    manifest.within_limits().map_err(Failure::usage)?;
    super::simulate::try_out(&manifest.programs[0], &manifest.settings).map_err(|error| {
        Failure::wrong_program(format!("{}: {error}", manifest.programs[0].name))
    })?;
    let results = all_runs(
        &manifest,
        options.threads,
        options.quiet,
        stop,
        "nothing was estimated",
    )?;
    let records: Vec<_> = results.finished.iter().map(|done| &done.record).collect();
    Ok(Estimate::of(&manifest.programs[0], &records))
}
