//! `stochc shard run`.
use std::path::PathBuf;

use clap::Args;
use stochc_files::shell::file as shell_file;
use stochc_results::Interval;
use stochc_text::visible;

use super::super::host::Terminal;
use super::super::interrupt::stop_on_interrupt;
use super::super::run_options::ThreadsOption;
use super::super::terminal::{is_quiet, print};
use crate::exit::{Exit, Failure};
use crate::operations::shard::shard;

/// Arguments of `shard run`.
#[derive(Debug, Args)]
pub struct RunArguments {
    /// Folder of `stochc shard new`
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Number of the shard, counted from 0
    #[arg(value_name = "I")]
    shard: u64,
    #[command(flatten)]
    work: ThreadsOption,
    /// Save running simulations at this interval. It is a time (90s, 5m, 2h), a number of ticks (20000ticks) or `never`.
    /// Simulations with `rapier` are not saved
    #[arg(long, value_name = "EVERY", default_value_t = Interval::DEFAULT)]
    checkpoints: Interval,
}

pub fn run(options: &RunArguments) -> Result<Exit, Failure> {
    stop_on_interrupt()?;
    let host = Terminal::default();
    let made = shard(
        &options.folder,
        options.shard,
        options.work.threads,
        options.checkpoints,
        &host,
    )?;
    let Some(runs) = made else {
        return Err(Failure {
            exit: Exit::Interrupted,
            message: "interrupted; finished runs are kept, and the same command continues\n"
                .to_owned(),
        });
    };
    let shown = visible(&options.folder.to_string_lossy());
    if !is_quiet() {
        let number = options.shard;
        print(&format!(
            "shard {number} of `{shown}` is complete: {runs} runs. Next: stochc shard status {}\n",
            shell_file(&shown)
        ))?;
    }
    Ok(Exit::Success)
}
