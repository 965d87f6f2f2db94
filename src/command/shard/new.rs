//! `stochc shard new`.
use std::path::PathBuf;

use clap::Args;
use stochc_experiments::sweep::Axis;
use stochc_files::shell::file as shell_file;
use stochc_results::MAX_RUNS;
use stochc_results::shards::{Prepared, prepare};
use stochc_text::visible;

use super::super::ensemble::{ProgramOptions, RUNS, input, judge};
use super::super::host::Terminal;
use super::super::interrupt::stop_on_interrupt;
use super::super::run_options::ThreadsOption;
use super::super::terminal::{is_quiet, print};
use crate::exit::{Exit, Failure};
use crate::operations::rates::MissingRates;

/// Arguments of `shard new`.
#[derive(Debug, Args)]
pub struct NewArguments {
    #[command(flatten)]
    programs: ProgramOptions,
    /// Number of shards
    #[arg(long, value_name = "M")]
    shards: u64,
    /// Folder for the shards. It must be new or empty
    #[arg(long, short, value_name = "DIR")]
    out: PathBuf,
    /// Number of runs of each program
    #[arg(long, short = 'n', value_name = "N", default_value_t = RUNS, value_parser = clap::value_parser!(u64).range(1..=MAX_RUNS))]
    runs: u64,
    /// Scene parameter or setting, and its values, in the format of `stochc sweep`
    #[arg(long, value_name = "NAME=VALUES", value_parser = Axis::parse)]
    vary: Vec<Axis>,
    #[command(flatten)]
    work: ThreadsOption,
}

pub fn run(options: &NewArguments) -> Result<Exit, Failure> {
    let (programs, shards) = (&options.programs, options.shards);
    let host = Terminal::default();
    stop_on_interrupt()?;
    let missing = MissingRates::Calibration(options.work.threads);
    let manifest = input::from_programs(programs, &options.vary, options.runs, missing, &host)?;
    judge(&manifest, true, &programs.source.levels.levels, &host)?;
    let prepared = prepare(&options.out, &manifest, shards).map_err(Failure::usage)?;
    if is_quiet() {
        return Ok(Exit::Success);
    }
    let shown = visible(&options.out.to_string_lossy());
    let folder = shell_file(&shown);
    let already = match prepared {
        Prepared::New => "",
        Prepared::Already => " already",
    };
    let (runs, last) = (manifest.total(), shards - 1);
    print(&format!(
        "`{shown}` is split into {shards} shards{already}, {runs} runs in all\n\
         To run each, on any machine, in any order: stochc shard run {folder} I, for I from 0 to {last}\n\
         To merge them: stochc shard merge {folder}\n"
    ))?;
    Ok(Exit::Success)
}
