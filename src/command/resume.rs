//! `stochc resume`.
use std::path::PathBuf;

use clap::Args;
use stochc_results::Resume;

use super::ensemble::{self, Ensemble, MakingOptions, input};
use super::figures::FigureOptions;
use super::host::Terminal;
use super::levels::LevelOptions;
use crate::exit::{Exit, Failure};

/// Help of `--runs`.
const RUNS: &str = "Number of runs of each program, including finished runs. With `--until`, the maximum [default: the number of the folder, or 10000 with `--until`]";

/// Arguments of `resume`.
#[derive(Debug, Args)]
#[command(mut_arg("runs", |it| it.help(RUNS)))]
pub struct ResumeArguments {
    /// Results folder
    #[arg(value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    making: MakingOptions,
    /// Also resume a folder of another build of stochc, if this build reproduces one of its runs exactly
    #[arg(long, help_heading = "Runs")]
    mixed_builds: bool,
    #[command(flatten)]
    figures: FigureOptions,
    #[command(flatten)]
    levels: LevelOptions,
}

pub fn run(options: &ResumeArguments) -> Result<Exit, Failure> {
    let host = Terminal::default();
    let ensemble = Ensemble {
        manifest: input::from_folder(&options.out, options.making.more_runs())?,
        out: Some(&options.out),
        resume: if options.mixed_builds {
            Resume::MixedBuilds
        } else {
            Resume::SameBuild
        },
        is_checked: false,
        levels: &options.levels.levels,
        figures: options.figures.figures(),
    };
    ensemble::run(ensemble, &options.making, &host)
}
