//! `stochc trade`.
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use stochc_experiments::trade::FINEST;
use stochc_report::tables::trade_to_text;
use stochc_results::MAX_RUNS;
use stochc_text::share;

use super::ensemble::{MAX_TICKS, stopped};
use super::figures::FigureOptions;
use super::host::Terminal;
use super::interrupt::stop_on_interrupt;
use super::run_options::MeasuringOptions;
use super::source_options::SourceOptions;
use super::terminal::{argument, close, output_has_colour, output_width, print, print_drawn};
use crate::exit::{Exit, Failure};
use crate::operations::forecast::{cpu_time, forecast_to_text};
use crate::operations::programs::programs;
use crate::operations::time;
use crate::operations::trade::{MeasuredTrade, TradeSetup, manifest, measured};

/// Arguments of `trade`.
#[derive(Debug, Args)]
#[command(mut_arg("figure_width", |it| it.requires("out")), mut_arg("figure_format", |it| it.requires("out")))]
pub struct TradeArguments {
    /// Programs to simulate. For several programs, the report also states which one is faster at each setting
    #[arg(value_name = "FILE", required = true)]
    files: Vec<String>,
    /// Number of runs of each program at each setting. With `--time` or `--until`, the maximum [default: 30, or
    /// 10000 with `--time` or `--until`]
    #[arg(long, short = 'n', value_name = "N", value_parser = clap::value_parser!(u64).range(2..=MAX_RUNS))]
    runs: Option<u64>,
    /// Start no more runs after this time, such as 90s, 10m or 2h
    #[arg(long, value_name = "TIME", value_parser = time)]
    time: Option<Duration>,
    /// Add runs until the mean time of every program is known to this precision, such as 3%. The precision is the half-width
    /// of the 95 % confidence interval
    #[arg(long, value_name = "PERCENT", value_parser = share, requires = "out", conflicts_with = "time")]
    until: Option<f64>,
    /// Stop each run after this many ticks. A stopped run counts as incomplete (right-censored)
    #[arg(long, value_name = "TICKS", default_value_t = MAX_TICKS, value_parser = clap::value_parser!(u64).range(1..))]
    max_ticks: u64,
    /// Largest number of substeps to simulate. The setting with most substeps is the reference
    #[arg(long, value_name = "N", default_value_t = FINEST, value_parser = clap::value_parser!(u32).range(1..=1000))]
    finest: u32,
    /// Folder for the results, with `trade.json` and the figure `trade.svg`. It must be new or empty
    #[arg(long, short, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Size and format of the figure.
    #[command(flatten)]
    figures: FigureOptions,
    /// Continue an interrupted measurement in the folder of `--out`, or add runs to a finished one
    #[arg(long, requires = "out")]
    resume: bool,
    /// Print the expected CPU time, and simulate nothing
    #[arg(long, conflicts_with_all = ["time", "until"])]
    dry_run: bool,
    #[command(flatten)]
    measuring: MeasuringOptions,
    #[command(flatten)]
    source: SourceOptions,
}

pub fn run(options: &TradeArguments) -> Result<Exit, Failure> {
    let MeasuringOptions {
        chance,
        work,
        output,
    } = &options.measuring;
    let host = Terminal::default();
    let source = options.source.settings();
    let programs = programs(&options.files, &source, &host)?;
    stop_on_interrupt()?;
    let setup = TradeSetup {
        runs: options.runs,
        time: options.time,
        until: options.until,
        finest: options.finest,
        max_ticks: options.max_ticks,
        seed: chance.seed,
        threads: work.threads,
        out: options.out.as_deref(),
        resume: options.resume,
        figures: &options.figures.figures(),
    };
    let manifest = manifest(programs, &setup, &host)?;
    if options.dry_run {
        let forecast = cpu_time(&manifest, &host)?;
        print(&forecast_to_text(&forecast, work.threads))?;
        return Ok(Exit::Success);
    }
    let MeasuredTrade {
        manifest,
        trade,
        is_complete,
    } = measured(manifest, &setup, &host)?;
    if output.json {
        print(&trade.to_json(&manifest))?;
    } else {
        print_drawn(&trade_to_text(&trade, output_width(), output_has_colour()))?;
    }
    if is_complete {
        if let Some(folder) = options.out.as_deref().map(argument) {
            close(&format!(
                "Saved in {folder}. Next: stochc report {folder}\n"
            ));
        }
        Ok(Exit::Success)
    } else {
        Err(stopped(options.out.as_deref()))
    }
}
