//! `stochc repeat`.
use std::path::PathBuf;

use clap::Args;
use stochc_results::Resume;

use super::ensemble::{self, Ensemble, MakingOptions, input};
use super::figures::FigureOptions;
use super::host::Terminal;
use super::levels::LevelOptions;
use crate::exit::{Exit, Failure};

/// Help of `--runs`.
const RUNS: &str = "Number of runs of each program. With `--until`, the maximum [default: the number of the manifest, or 10000 with `--until`]";

/// Arguments of `repeat`.
#[derive(Debug, Args)]
#[command(mut_arg("runs", |it| it.help(RUNS)), mut_arg("figure_width", |it| it.requires("out")), mut_arg("figure_format", |it| it.requires("out")))]
pub struct RepeatArguments {
    /// Results folder, or its `manifest.json`
    #[arg(value_name = "DIR|MANIFEST")]
    from: PathBuf,
    /// Folder for the new results. It must be new or empty
    #[arg(long, short, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    making: MakingOptions,
    #[command(flatten)]
    figures: FigureOptions,
    #[command(flatten)]
    levels: LevelOptions,
}

pub fn run(options: &RepeatArguments) -> Result<Exit, Failure> {
    let host = Terminal::default();
    let runs = options.making.more_runs();
    let ensemble = Ensemble {
        manifest: input::from_manifest(&options.from, runs, &host)?,
        out: options.out.as_deref(),
        resume: Resume::No,
        is_checked: false,
        levels: &options.levels.levels,
        figures: options.figures.figures(),
    };
    ensemble::run(ensemble, &options.making, &host)
}
