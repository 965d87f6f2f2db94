//! The folder of what was submitted to Slurm, within that of the results.
use std::io;
use std::path::Path;

use stochc_files::atomic::remove_own;

/// What it is called.
pub(crate) const SLURM: &str = "slurm";
/// The jobs that were submitted.
pub(crate) const JOBS_FILE: &str = "jobs.json";
/// Held by the process that submits.
pub(crate) const LOCK: &str = ".lock";
/// Of the jobs that make pieces.
pub(crate) const PIECES_SCRIPT: &str = "pieces.sh";
/// Of the job that puts them together.
pub(crate) const MERGE_SCRIPT: &str = "merge.sh";

/// Removes what was submitted for the ensemble at `path`, if anything was.
pub(crate) fn clear(path: &Path) -> io::Result<()> {
    remove_own(&path.join(SLURM), |name| {
        [JOBS_FILE, LOCK, PIECES_SCRIPT, MERGE_SCRIPT].contains(&name) || name.ends_with(".log")
    })
}
