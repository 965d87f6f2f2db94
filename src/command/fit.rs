//! `stochc fit`.
use std::io;
use std::path::{Path, PathBuf};

use clap::Args;
use stochc_experiments::fit::{Fit, Prior};
use stochc_files::atomic::{self, Replaces};
use stochc_files::disk;
use stochc_report::figures::fit as fit_figure;
use stochc_report::tables::fit_to_text;
use stochc_results::is_remnant;
use stochc_runtime::{Settings, Substeps};

use super::figures::FigureOptions;
use super::host::Terminal;
use super::interrupt::stop_on_interrupt;
use super::run_options::MeasuringOptions;
use super::source_options::SourceOptions;
use super::terminal::{argument, close, is_quiet, output_width, print, warn};
use crate::exit::{Exit, Failure};
use crate::operations::fit::{
    FitSetup, Unused, check_priors, fit, fitted_scenes, forecast, matched, measured_times,
};
use crate::operations::forecast::forecast_to_text;
use crate::operations::json::document;
use crate::operations::programs::programs;

/// Arguments of `fit`.
#[derive(Debug, Args)]
#[command(mut_arg("figure_width", |it| it.requires("out")), mut_arg("figure_format", |it| it.requires("out")))]
pub struct FitArguments {
    /// Programs whose times were measured
    #[arg(value_name = "FILE", required = true)]
    files: Vec<String>,
    /// Results folder of `stochc import`, or CSV file with measured times. From a folder, the fit uses the waiting time of each
    /// capture. In a file, the header is `program,ticks`, with a row for each run, or
    /// `program,n,mean_ticks,sd_ticks`. Times can be in `seconds` instead of `ticks`. In a third column `stopped`, `true`
    /// marks a run that was stopped at this time
    #[arg(long, value_name = "DIR|FILE.csv")]
    data: PathBuf,
    /// Scene parameter to fit, and its range. Examples: `bond.pull=2..12 N` and `free=50..500 log`
    #[arg(long, value_name = "NAME=RANGE", required = true, value_parser = Prior::parse)]
    vary: Vec<Prior>,
    /// Predict the times of this program instead of using them in the fit
    #[arg(long, value_name = "PROGRAM")]
    hold_out: Vec<String>,
    /// Predict the times of this program, which has no measured times
    #[arg(long, value_name = "PROGRAM")]
    predict: Vec<String>,
    /// `--predict` predicts the mean and the standard deviation of this number of runs
    #[arg(long, value_name = "N", default_value_t = 30, requires = "predict", value_parser = clap::value_parser!(u32).range(2..))]
    predict_runs: u32,
    /// Number of parameter sets that each round simulates, 8 to 200 [default: depends on the number of parameters]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(8..=200))]
    points: Option<u16>,
    /// Number of rounds, 1 to 10. Each round narrows the ranges for the next one
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=10))]
    rounds: u8,
    /// Number of runs of each program with each parameter set, 4 to 10,000
    #[arg(long, short = 'n', value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u64).range(4..=10_000))]
    runs: u64,
    /// Time steps per tick. `2/8` means eight steps for blocks near open faces, and two for all other blocks. Scenes with a
    /// fluid, a flow or `bond reject` take eight steps for all blocks
    #[arg(long, value_name = "STEPS", default_value_t = Substeps::DEFAULT)]
    substeps: Substeps,
    /// Stop each simulated run after this many ticks. Waiting times that are then incomplete count as right-censored.
    /// Incomplete completion times are not used, except if measured runs were stopped, too
    #[arg(long, value_name = "TICKS", default_value_t = 200_000, value_parser = clap::value_parser!(u64).range(1..))]
    max_ticks: u64,
    /// Folder for `fit.json`, the figure `fit.svg`, and `fitted.sa` with the fitted scenes. It must be new or empty
    #[arg(long, short, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    /// Print the expected CPU time, and simulate nothing
    #[arg(long)]
    dry_run: bool,
    /// Size and format of the figure.
    #[command(flatten)]
    figures: FigureOptions,
    #[command(flatten)]
    measuring: MeasuringOptions,
    #[command(flatten)]
    source: SourceOptions,
}

pub fn run(options: &FitArguments) -> Result<Exit, Failure> {
    let host = Terminal::default();
    let times = measured_times(&options.data, &host)?;
    let source = options.source.settings();
    let programs = programs(&options.files, &source, &host)?;
    let unused = Unused {
        held_out: &options.hold_out,
        predicted: &options.predict,
        n: options.predict_runs as usize,
    };
    let measured = matched(programs, times.programs, unused)?;
    let priors = check_priors(options.vary.clone(), &measured)?;
    let setup = FitSetup {
        priors: &priors,
        points: options.points.map(usize::from),
        rounds: options.rounds.into(),
        runs: options.runs,
        unit: times.unit,
        settings: Settings {
            max_ticks: Some(options.max_ticks),
            ..Settings::default().with_steps(options.substeps)
        },
        seed: options.measuring.chance.seed,
        threads: options.measuring.work.threads,
        levels: &source.levels,
    };
    if options.dry_run {
        let forecast = forecast(&setup, &measured, &host)?;
        print(&forecast_to_text(&forecast, setup.threads))?;
        return Ok(Exit::Success);
    }
    if let Some(out) = &options.out {
        claim_empty(out).map_err(Failure::usage)?;
    }
    stop_on_interrupt()?;
    if !is_quiet() {
        let forecast = forecast(&setup, &measured, &host)?;
        warn(&forecast_to_text(&forecast, setup.threads));
    }
    let fit = fit(&setup, &measured, &host)?;
    if options.measuring.output.json {
        print(&document(&fit))?;
    } else {
        print(&fit_to_text(&fit, &priors, output_width()))?;
    }
    if let Some(out) = &options.out {
        let scenes = fitted_scenes(&setup, &measured, &fit, &host)?;
        keep(out, &fit, &scenes, &figures(&fit, &priors, options)?)?;
        let scenes = argument(&out.join("fitted.sa"));
        close(&format!(
            "Saved in {}. Next: stochc check {scenes} --physics\n",
            argument(out)
        ));
    }
    Ok(Exit::Success)
}

/// Returns the name and content of each file of the fit's figure.
fn figures(
    fit: &Fit,
    priors: &[Prior],
    options: &FitArguments,
) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let figures = options.figures.figures();
    let drawn = figures.files(&fit_figure(figures.medium, fit, priors));
    drawn.map_err(Failure::usage)
}

fn keep(out: &Path, fit: &Fit, scenes: &str, figures: &[(String, Vec<u8>)]) -> Result<(), Failure> {
    let mut files = figures.to_vec();
    files.push(("fit.json".to_owned(), document(fit).into_bytes()));
    files.push(("fitted.sa".to_owned(), scenes.as_bytes().to_vec()));
    for (name, content) in files {
        let path = out.join(name);
        stochc_files::atomic::replace(&path, &content, Replaces::Nothing)
            .map_err(|error| Failure::not_written(&path, error))?;
    }
    if fit.stopped > 0 {
        close(&format!(
            "note: {} simulated times are not used, because they are incomplete\n",
            fit.stopped
        ));
    }
    Ok(())
}

/// Creates a folder. Accepts an existing folder if it contains only leftovers of killed processes,
/// or nothing.
fn claim_empty(out: &Path) -> Result<(), String> {
    let shown = out.display();
    let unusable = |error: io::Error| format!("cannot use `{shown}`: {error}");
    if out.exists() && !out.is_dir() {
        return Err(format!(
            "`{shown}` is a file; choose another name for the folder"
        ));
    }
    atomic::make_folder(out).map_err(unusable)?;
    let entries = disk::list(out).map_err(unusable)?;
    if entries.iter().all(|entry| is_remnant(entry)) {
        Ok(())
    } else {
        Err(format!(
            "`{shown}` is not empty; choose an empty or a new folder"
        ))
    }
}
