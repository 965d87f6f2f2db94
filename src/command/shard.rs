//! `stochc shard`.
use std::path::PathBuf;

use clap::Args;
use stochc_ensemble::Interval;
use stochc_ensemble::shards::Piece;
use stochc_ensemble::text::visible;

use super::interrupt::stop_on_interrupt;
use super::progress::{Display, of_ensemble};
use super::simulate::{made_again, made_by, tell_of_checkpoints};
use super::terminal::{print, warn};
use super::trade::threads;
use crate::exit::{Exit, Failure};

/// What `shard` is given.
#[derive(Debug, Args)]
pub struct Options {
    /// Folder of `simulate --shards`
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Number of the piece, from 0
    #[arg(value_name = "I")]
    piece: u64,
    /// Number of runs at the same time [default: number of cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Keep the states of runs under way so often, for the same command to go on from: a time (90s, 5m, 2h), ticks of each
    /// run (20000ticks) or `never`
    #[arg(long, value_name = "EVERY", default_value_t = Interval::DEFAULT)]
    checkpoints: Interval,
    /// Do not show progress, nor that the piece is made
    #[arg(long, short)]
    quiet: bool,
}

/// Makes a piece of an ensemble, or what is missing of it.
pub fn run(options: &Options) -> Result<Exit, Failure> {
    let stop = stop_on_interrupt()?;
    let piece = Piece::open(&options.folder, options.piece)
        .and_then(|piece| piece.with_checkpoints(options.checkpoints))
        .map_err(Failure::usage)?;
    tell_of_checkpoints(piece.checkpoints());
    let shown = visible(&options.folder.to_string_lossy());
    let (runs, done) = piece.runs();
    if !piece.is_made() {
        let manifest = piece.manifest();
        let again = piece.check_stored(made_again(manifest, stop));
        again.map_err(Failure::usage)?;
        let progress = piece.progress(threads(options.threads));
        let state = |elapsed| of_ensemble(manifest, &progress, elapsed);
        let display = match done == runs {
            // There is nothing to wait for.
            true => Display::Quiet,
            false => Display::on_standard_error(options.quiet),
        };
        let simulate = made_by(manifest);
        let made = display.during(state, || piece.make(&progress, stop, simulate));
        tell_of_checkpoints(piece.checkpoints());
        if !made.map_err(Failure::usage)? {
            warn("stopped; finished runs are kept, and the same command continues\n");
            return Ok(Exit::Interrupted);
        }
    }
    if !options.quiet {
        let number = options.piece;
        print(&format!(
            "piece {number} of `{shown}` is there: {runs} runs\n"
        ))?;
    }
    Ok(Exit::Success)
}
