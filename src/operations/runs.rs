//! Functions that make the runs of a manifest, for [`stochc_results::run`] and shards.
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

use stochc_ir::record::RunRecord;
use stochc_results::{Checkpoints, Manifest, RunCancelled, RunWatch, other_build, until};

use crate::exit::Failure;
use crate::host::Host;

/// Returns a function that makes a run of an ensemble, for [`stochc_results::run`].
pub fn made_by(
    manifest: &Manifest,
) -> impl Fn(usize, u64, &RunWatch) -> Result<RunRecord, RunCancelled> + Sync {
    |program, number, mut watch| made(manifest, program, number, &mut watch)
}

/// Returns a function that repeats a run of an ensemble. The run stops if `stop` is set.
pub fn made_again(
    manifest: &Manifest,
    stop: &AtomicBool,
) -> impl FnOnce(usize, u64) -> Result<RunRecord, RunCancelled> {
    |program, number| made(manifest, program, number, &mut until(stop))
}

fn made(
    manifest: &Manifest,
    program: usize,
    run: u64,
    watch: &mut impl stochc_runtime::Watch,
) -> Result<RunRecord, RunCancelled> {
    let program = &manifest.programs[program];
    let settings = manifest.settings_of(program);
    let record = program.run(&settings, manifest.seed, run, watch);
    // [`try_out_all`] has checked the scene, so the only possible error is an interrupt.
    record.map_err(|_| RunCancelled)
}

/// Sets up the scene of every program once, so that errors appear before the first run.
///
/// # Errors
/// If a scene cannot be set up.
pub fn try_out_all(manifest: &Manifest) -> Result<(), Failure> {
    let mut programs = manifest.programs.iter();
    programs.try_for_each(|program| {
        (program.try_out(&manifest.settings_of(program)))
            .map_err(|error| Failure::invalid_program(format!("{}: {error}", program.name)))
    })
}

/// Warns if builds other than this one made some of the runs.
pub(crate) fn warn_of_build(builds: &[String], host: &dyn Host) {
    if let Some(warning) = other_build(builds) {
        host.warn(&format!("warning: {warning}\n"));
    }
}

pub(crate) fn warn_of_checkpoints(checkpoints: Option<&Checkpoints>, host: &dyn Host) {
    for note in checkpoints.map(Checkpoints::notes).unwrap_or_default() {
        host.note(&format!("note: {note}\n"));
    }
}

/// Returns the number of threads to use: `requested`, or one per core by default.
pub fn threads(requested: Option<u16>) -> NonZeroUsize {
    let cores = || std::thread::available_parallelism().ok();
    let threads = requested.map_or_else(cores, |requested| NonZeroUsize::new(requested.into()));
    threads.unwrap_or(NonZeroUsize::MIN)
}
