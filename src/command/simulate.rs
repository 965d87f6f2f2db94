//! `stochc simulate`.
use std::path::PathBuf;

use clap::Args;
use stochc_report::figures::Figures;
use stochc_results::Resume;

use super::ensemble::{self, Ensemble, MakingOptions, ProgramOptions, input};
use super::host::Terminal;
use crate::exit::{Exit, Failure};

/// Arguments of `simulate`.
#[derive(Debug, Args)]
pub struct SimulateArguments {
    #[command(flatten)]
    programs: ProgramOptions,
    /// Folder for the results. It must be new or empty
    #[arg(long, short, value_name = "DIR", help_heading = "Output")]
    out: Option<PathBuf>,
    #[command(flatten)]
    making: MakingOptions,
}

pub fn run(options: &SimulateArguments) -> Result<Exit, Failure> {
    let (programs, making) = (&options.programs, &options.making);
    let host = Terminal::default();
    let runs = making.new_runs();
    let manifest = input::from_programs(programs, &[], runs, making.missing_rates(), &host)?;
    let ensemble = Ensemble {
        manifest,
        out: options.out.as_deref(),
        resume: Resume::No,
        is_checked: true,
        levels: &programs.source.levels.levels,
        figures: Figures::default(),
    };
    ensemble::run(ensemble, making, &host)
}
