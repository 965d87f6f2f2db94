//! `stochc estimate`.
use std::path::PathBuf;

use clap::Args;
use serde_json::json;
use stochc_report::estimate::CompletionEstimate;
use stochc_report::tables::{estimates_to_text, remaining_to_text};
use stochc_results::MAX_RUNS;

use super::host::Terminal;
use super::interrupt::stop_on_interrupt;
use super::run_options::{ALL, MeasuringOptions, RatesOption, count};
use super::source_options::SourceOptions;
use super::terminal::{output_width, print};
use crate::exit::{Exit, Failure};
use crate::operations::estimate::{Estimating, estimates, remaining};
use crate::operations::json::document;
use crate::operations::programs::programs;

/// Arguments of `estimate`.
#[derive(Debug, Args)]
#[command(mut_arg("seed", |it| it.requires("runs")))]
pub struct EstimateArguments {
    /// Programs (`*.sa`) or compiled programs
    #[arg(value_name = "FILE", required_unless_present = "remaining")]
    files: Vec<String>,
    /// Estimate the remaining time of the runs in progress in this results folder of `stochc import`
    #[arg(long, value_name = "DIR", conflicts_with_all = ["files", "runs", "captures"])]
    remaining: Option<PathBuf>,
    #[command(flatten)]
    rates: RatesOption,
    /// Estimate from N runs of the rate model per program (2 to 10,000,000). The default adds waiting times along the
    /// dependency graph
    #[arg(long, short = 'n', value_name = "N", value_parser = clap::value_parser!(u64).range(2..=MAX_RUNS))]
    runs: Option<u64>,
    /// List the N captures that take most of the time. Without N, list all captures [default: 5]
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, default_value = SHOWN, default_missing_value = ALL, hide_default_value = true, value_parser = count)]
    captures: usize,
    /// Stop each run of `--runs` after this many ticks
    #[arg(long, value_name = "TICKS", requires = "runs", default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..))]
    max_ticks: u64,
    #[command(flatten)]
    measuring: MeasuringOptions,
    #[command(flatten)]
    source: SourceOptions,
}

pub fn run(options: &EstimateArguments) -> Result<Exit, Failure> {
    let MeasuringOptions {
        chance,
        work,
        output,
    } = &options.measuring;
    let host = Terminal::default();
    if let Some(folder) = &options.remaining {
        stop_on_interrupt()?;
        let runs = remaining(folder, &options.rates.rates, &host)?;
        print(&if output.json {
            document(json!({ "remaining": runs }))
        } else {
            remaining_to_text(&runs, output_width())
        })?;
        return Ok(Exit::Success);
    }
    let source = options.source.settings();
    let programs = programs(&options.files, &source, &host)?;
    stop_on_interrupt()?;
    let how = Estimating {
        rates: &options.rates.rates,
        runs: options.runs,
        max_ticks: options.max_ticks,
        seed: chance.seed,
        threads: work.threads,
    };
    print_estimates(
        &estimates(programs, &how, &host)?,
        options.captures,
        output.json,
    )
}

/// Default number of captures in the list.
const SHOWN: &str = "5";

/// Prints estimates, each with up to `captures` captures. Returns [`Exit::UnsuccessfulRun`] if an
/// estimate has no times.
fn print_estimates(
    estimates: &[CompletionEstimate],
    captures: usize,
    is_json: bool,
) -> Result<Exit, Failure> {
    if is_json {
        print(&document(json!({ "estimates": estimates })))?;
    } else {
        print(&estimates_to_text(estimates, captures, output_width()))?;
    }
    let is_known = |estimate: &CompletionEstimate| estimate.total.is_some();
    Ok(Exit::from_runs(estimates.iter().all(is_known)))
}
