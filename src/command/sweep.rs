//! `stochc sweep`.
use std::path::PathBuf;

use clap::Args;
use stochc_experiments::sweep::Axis;
use stochc_results::Resume;

use super::ensemble::{self, Ensemble, MakingOptions, ProgramOptions, input};
use super::figures::FigureOptions;
use super::host::Terminal;
use crate::exit::{Exit, Failure};

/// Arguments of `sweep`.
#[derive(Debug, Args)]
#[command(mut_arg("figure_width", |it| it.requires("out")), mut_arg("figure_format", |it| it.requires("out")))]
pub struct SweepArguments {
    #[command(flatten)]
    programs: ProgramOptions,
    /// Scene parameter or setting, and its values. Examples: `free=50..600/6` or `bond.pull=2..12 N/5 log` or
    /// `substeps=1,2,4`. If given several times, every combination is simulated
    #[arg(long, value_name = "NAME=VALUES", required = true, help_heading = "Runs", value_parser = Axis::parse)]
    vary: Vec<Axis>,
    /// Folder for the results. It must be new or empty
    #[arg(long, short, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    making: MakingOptions,
    #[command(flatten)]
    figures: FigureOptions,
}

pub fn run(options: &SweepArguments) -> Result<Exit, Failure> {
    let (programs, making) = (&options.programs, &options.making);
    let host = Terminal::default();
    let (runs, missing) = (making.new_runs(), making.missing_rates());
    let manifest = input::from_programs(programs, &options.vary, runs, missing, &host)?;
    let ensemble = Ensemble {
        manifest,
        out: options.out.as_deref(),
        resume: Resume::No,
        is_checked: true,
        levels: &programs.source.levels.levels,
        figures: options.figures.figures(),
    };
    ensemble::run(ensemble, making, &host)
}
