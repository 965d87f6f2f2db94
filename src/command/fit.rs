//! `stochc fit`.
use std::path::{Path, PathBuf};

use clap::Args;
use stochc_ensemble::fit::{Fit, Prior};
use stochc_files::atomic::Replaces;
use stochc_report::figures::{Figures, fit as fit_figure};
use stochc_report::tables::fit_to_text;
use stochc_runtime::{Settings, Substeps};

use super::figures::FigureOptions;
use super::host::Terminal;
use super::imports::ImportOptions;
use super::interrupt::stop_on_interrupt;
use super::levels::LevelOptions;
use super::run_options::MeasuringOptions;
use super::show::ResultsFormat;
use super::terminal::{output_width, print, warn};
use crate::exit::{Exit, Failure};
use crate::operations::fit::{FitSetup, fit, matched, measured_times, of_scenes};
use crate::operations::programs::programs;
use crate::operations::trade::claim_empty;

/// What `fit` is given.
#[derive(Debug, Args)]
#[command(mut_arg("figures", |it| it.requires("out")), mut_arg("figure_format", |it| it.requires("out")))]
pub struct FitArguments {
    /// Programs whose times were measured
    #[arg(value_name = "FILE", required = true)]
    files: Vec<String>,
    /// Measured times (CSV): `program,ticks` with a row for each run, or `program,n,mean_ticks,sd_ticks`; `seconds` in
    /// place of ticks
    #[arg(long, value_name = "FILE.csv")]
    data: PathBuf,
    /// A number of the scene to find, and the range that it may be in: `bond.pull=2..12 N`, `free=50..500 log`
    #[arg(long, value_name = "NAME=RANGE", required = true, value_parser = Prior::parse)]
    vary: Vec<Prior>,
    /// Predict the times of this program, and do not use them
    #[arg(long, value_name = "PROGRAM")]
    hold_out: Vec<String>,
    /// Simulate at so many points in each round, 8 to 200 [default: three for each coefficient of the polynomials]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(8..=200))]
    points: Option<u16>,
    /// Rounds, 1 to 10, each within what the one before has left
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=10))]
    rounds: u8,
    /// Runs of each program at each point, 4 to 10,000
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u64).range(4..=10_000))]
    runs: u64,
    /// Steps of the model in each tick; `1/8`: one, and eight for blocks near magnetized faces
    #[arg(long, value_name = "STEPS", default_value_t = Substeps::DEFAULT)]
    substeps: Substeps,
    /// Stop a run after this many ticks; its time then counts for nothing, and is told of
    #[arg(long, value_name = "TICKS", default_value_t = 200_000, value_parser = clap::value_parser!(u64).range(1..))]
    max_ticks: u64,
    /// Folder for `fit.json` and the figure `fit.svg`; it must be new or empty
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// What its figure is like.
    #[command(flatten)]
    figures: FigureOptions,
    #[command(flatten)]
    measuring: MeasuringOptions,
    /// What becomes of warnings
    #[command(flatten)]
    levels: LevelOptions,
    #[command(flatten)]
    imports: ImportOptions,
}

/// Finds numbers of scenes that measured times speak for.
pub fn run(options: &FitArguments) -> Result<Exit, Failure> {
    let (unit, observed) = measured_times(&options.data)?;
    let host = Terminal::new(options.measuring.work.quiet);
    let (levels, imports) = (&options.levels.levels, &options.imports.folders);
    let programs = programs(&options.files, levels, imports, &host)?;
    let measured = matched(programs, observed, &options.hold_out)?;
    let priors = of_scenes(options.vary.clone(), &measured)?;
    let setup = FitSetup {
        priors: &priors,
        points: options.points.map(usize::from),
        rounds: options.rounds.into(),
        runs: options.runs,
        settings: Settings {
            max_ticks: Some(options.max_ticks),
            ..Settings::default().with_steps(options.substeps)
        },
        seed: options.measuring.chance.seed,
        threads: options.measuring.work.threads,
        levels,
    };
    if let Some(out) = &options.out {
        claim_empty(out, |_| false).map_err(Failure::usage)?;
    }
    stop_on_interrupt()?;
    let fit = fit(&setup, &measured, unit, &host)?;
    match options.measuring.format {
        ResultsFormat::Text => print(&fit_to_text(&fit, &priors, output_width()))?,
        ResultsFormat::Json => print(&json(&fit))?,
    }
    if let Some(out) = &options.out {
        keep(out, &fit, &priors, &options.figures.figures())?;
    }
    Ok(Exit::Success)
}

fn json(fit: &Fit) -> String {
    let text = serde_json::to_string_pretty(fit).expect("a fit is plain data");
    text + "\n"
}

fn keep(out: &Path, fit: &Fit, priors: &[Prior], figures: &Figures) -> Result<(), Failure> {
    let drawn = figures.files(&fit_figure(figures.medium, fit, priors));
    let mut files = drawn.map_err(Failure::usage)?;
    files.push(("fit.json".to_owned(), json(fit).into_bytes()));
    for (name, content) in files {
        let path = out.join(name);
        stochc_files::atomic::replace(&path, &content, Replaces::Nothing)
            .map_err(|error| Failure::not_written(&path, error))?;
    }
    if fit.stopped > 0 {
        warn(&format!(
            "note: {} of {} runs were stopped before they completed, and count for nothing\n",
            fit.stopped, fit.runs
        ));
    }
    Ok(())
}
