//! `stochc shard`.
use std::path::PathBuf;

use clap::Args;
use stochc_ensemble::Interval;
use stochc_ensemble::text::visible;

use super::host::Terminal;
use super::interrupt::stop_on_interrupt;
use super::run_options::WorkOptions;
use super::terminal::{print, warn};
use crate::exit::{Exit, Failure};
use crate::operations::shard::shard;

/// What `shard` is given.
#[derive(Debug, Args)]
pub struct ShardArguments {
    /// Folder of `simulate --shards`
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Number of the piece, from 0
    #[arg(value_name = "I")]
    piece: u64,
    #[command(flatten)]
    work: WorkOptions,
    /// Keep the states of runs under way so often, for the same command to go on from: a time (90s, 5m, 2h), ticks of each
    /// run (20000ticks) or `never`. `rapier` runs have no checkpoints
    #[arg(long, value_name = "EVERY", default_value_t = Interval::DEFAULT)]
    checkpoints: Interval,
}

/// Makes a piece of an ensemble, or what is missing of it.
pub fn run(options: &ShardArguments) -> Result<Exit, Failure> {
    stop_on_interrupt()?;
    let host = Terminal::new(options.work.quiet);
    let made = shard(
        &options.folder,
        options.piece,
        options.work.threads,
        options.checkpoints,
        &host,
    )?;
    let Some(runs) = made else {
        warn("stopped; finished runs are kept, and the same command continues\n");
        return Ok(Exit::Interrupted);
    };
    let shown = visible(&options.folder.to_string_lossy());
    if !options.work.quiet {
        let number = options.piece;
        print(&format!(
            "piece {number} of `{shown}` is there: {runs} runs\n"
        ))?;
    }
    Ok(Exit::Success)
}
