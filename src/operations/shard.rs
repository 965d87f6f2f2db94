//! Runs of a shard of an ensemble, and merging of all shards.
use std::path::Path;

use stochc_results::Interval;
use stochc_results::shards::{Shard, ShardError, merge as merge_all};

use super::runs::{made_again, made_by, threads, warn_of_checkpoints};
use super::sweep;
use crate::exit::{Exit, Failure};
use crate::host::{Host, during};
use crate::progress::work_progress;

/// Makes the missing runs of a shard. Returns the number of runs in the shard, or `None` if the
/// user interrupts.
///
/// # Errors
/// If the shard does not exist, or its folder cannot be used. Finished runs are not lost.
pub fn shard(
    folder: &Path,
    number: u64,
    at_once: Option<u16>,
    checkpoints: Interval,
    host: &dyn Host,
) -> Result<Option<u64>, Failure> {
    let stop = host.stop();
    let shard = Shard::open(folder, number)
        .and_then(|shard| shard.with_checkpoints(checkpoints))
        .map_err(Failure::usage)?;
    warn_of_checkpoints(shard.checkpoints(), host);
    let (runs, done) = shard.runs();
    if shard.is_made() {
        return Ok(Some(runs));
    }
    let manifest = shard.manifest();
    let again = shard.check_stored(made_again(manifest, stop));
    again.map_err(Failure::usage)?;
    let progress = shard.progress(threads(at_once));
    let state = |elapsed| work_progress(manifest, &progress, elapsed);
    let work = || shard.make(&progress, stop, made_by(manifest));
    let made = if done == runs {
        work()
    } else {
        during(host, state, work)
    };
    warn_of_checkpoints(shard.checkpoints(), host);
    Ok(made.map_err(Failure::usage)?.then_some(runs))
}

/// Merges the shards of an ensemble. Returns the number of runs.
///
/// # Errors
/// If runs are missing, or shards belong to different ensembles.
pub fn merge(folder: &Path) -> Result<u64, Failure> {
    merge_all(folder, sweep::files_for_screens).map_err(|error| match error {
        ShardError::Missing { .. } => Failure::error(Exit::UnsuccessfulRun, error),
        error => Failure::usage(error),
    })
}
