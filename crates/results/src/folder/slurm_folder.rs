//! The folder with the files for Slurm, within a results folder.
use std::io;
use std::path::Path;

use stochc_files::atomic::remove_own;

pub(crate) const SLURM: &str = "slurm";
/// Lock file of the process that submits.
pub(crate) const LOCK: &str = ".lock";
pub(crate) const SHARDS_SCRIPT: &str = "shards.sh";
pub(crate) const MERGE_SCRIPT: &str = "merge.sh";

/// Removes the folder for Slurm of the ensemble at `path`, if there is one.
pub(crate) fn clear(path: &Path) -> io::Result<()> {
    remove_own(&path.join(SLURM), |name| {
        [LOCK, SHARDS_SCRIPT, MERGE_SCRIPT].contains(&name) || name.ends_with(".log")
    })
}
