//! `stochc trace`: simulates one run and prints its events.
use clap::Args;
use stochc_results::until;

use super::ensemble::{ProgramOptions, input, judge};
use super::host::Terminal;
use super::interrupt::stop_on_interrupt;
use super::narrative::show_runs;
use super::run_options::JsonOption;
use crate::exit::{Exit, Failure};
use crate::operations::rates::MissingRates;

/// Arguments of `trace`.
#[derive(Debug, Args)]
pub struct TraceArguments {
    #[command(flatten)]
    programs: ProgramOptions,
    /// Number of the run, counted from 0
    #[arg(long, value_name = "N", default_value_t = 0)]
    run: u64,
    #[command(flatten)]
    output: JsonOption,
}

pub fn run(options: &TraceArguments) -> Result<Exit, Failure> {
    let host = Terminal::default();
    let stop = stop_on_interrupt()?;
    let manifest = input::from_programs(
        &options.programs,
        &[],
        1,
        MissingRates::Calibration(None),
        &host,
    )?;
    judge(
        &manifest,
        true,
        &options.programs.source.levels.levels,
        &host,
    )?;
    let mut watch = until(stop);
    let mut records = Vec::new();
    for program in &manifest.programs {
        let settings = manifest.settings_of(program);
        let Ok(record) = program.run(&settings, manifest.seed, options.run, &mut watch) else {
            return Ok(Exit::Interrupted);
        };
        records.push((record, program));
    }
    show_runs(&records, options.output.json)
}
