//! Import of measured runs into a results folder.
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Mutex;

use stochc_files::budget::LOG;
use stochc_files::read_file;
use stochc_results::{
    Destination, EnsembleProgram, ExperimentLog, Folder, Manifest, Progress, Records, Resume,
    RunCancelled, RunWatch, run,
};

use crate::exit::Failure;
use crate::host::Host;

/// Reads the log of an experiment with a program into a new results folder. Returns its manifest
/// and runs.
///
/// # Errors
/// If the log is invalid, or the folder has other results.
pub fn import(
    file: &Path,
    program: &EnsembleProgram,
    out: &Path,
    host: &dyn Host,
) -> Result<(Manifest, Records), Failure> {
    let shown = file.display();
    let bytes = read_file(file, LOG)
        .map_err(|error| Failure::usage(format!("cannot read {shown}: {error}")))?;
    let invalid = |error| Failure::usage(format!("`{shown}`: {error}"));
    let log = ExperimentLog::new(&bytes, program).map_err(invalid)?;
    let manifest = log.manifest().map_err(invalid)?;
    let records = Mutex::new(log.records().map_err(invalid)?.flatten());
    // An import that was killed may have left some of the runs in the folder.
    let folder = Folder::open(out, &manifest, Resume::MixedBuilds).map_err(Failure::usage)?;
    let progress = Progress::new(&manifest, NonZeroUsize::MIN);
    // A single thread takes the runs in the order of the log.
    let record = |_: usize, run: u64, _: &RunWatch| {
        let mut records = records.lock().expect("no thread has panicked");
        records.find(|it| it.run == run).ok_or(RunCancelled)
    };
    let results = run(Destination::Folder(folder), &progress, host.stop(), record);
    Ok((manifest, results.map_err(Failure::usage)?.finished))
}
