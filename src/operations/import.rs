//! Import of measured runs into a results folder.
use std::num::NonZeroUsize;
use std::path::Path;

use stochc_files::budget::LOG;
use stochc_files::read_file;
use stochc_results::{
    Destination, EnsembleProgram, Folder, Manifest, MeasuredRuns, Progress, Records, Resume,
    RunWatch, read_log, run,
};

use crate::exit::Failure;
use crate::host::Host;

/// Reads the log of an experiment with a program into a new results folder. Returns its manifest
/// and runs.
///
/// # Errors
/// If the log is invalid, or the folder has other results.
pub fn import(
    log: &Path,
    program: EnsembleProgram,
    out: &Path,
    host: &dyn Host,
) -> Result<(Manifest, Records), Failure> {
    let shown = log.display();
    let bytes = read_file(log, LOG)
        .map_err(|error| Failure::usage(format!("cannot read {shown}: {error}")))?;
    let runs =
        read_log(&bytes, program).map_err(|error| Failure::usage(format!("`{shown}`: {error}")))?;
    drop(bytes);
    let MeasuredRuns { manifest, records } = runs;
    // An import that was killed may have left some of the runs in the folder.
    let folder = Folder::open(out, &manifest, Resume::MixedBuilds).map_err(Failure::usage)?;
    let progress = Progress::new(&manifest, NonZeroUsize::MIN);
    let record = |_: usize, run: u64, _: &RunWatch| Ok(records[run as usize].clone());
    let results = run(Destination::Folder(folder), &progress, host.stop(), record);
    Ok((manifest, results.map_err(Failure::usage)?.finished))
}
