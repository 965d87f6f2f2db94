//! Runs of a manifest, made as whoever makes many of them asks for them.
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

use stochc_ir::record::RunRecord;
use stochc_results::{Checkpoints, Manifest, RunCancelled, RunWatch, other_build, until};

use crate::exit::Failure;
use crate::host::Host;

/// Makes runs of an ensemble, as [`stochc_results::run`] asks for them.
pub fn made_by(
    manifest: &Manifest,
) -> impl Fn(usize, u64, &RunWatch) -> Result<RunRecord, RunCancelled> + Sync {
    |program, number, mut watch| made(manifest, (program, number), &mut watch)
}

/// Makes a run of an ensemble again, unless it is stopped.
pub fn made_again(
    manifest: &Manifest,
    stop: &AtomicBool,
) -> impl FnOnce(usize, u64) -> Result<RunRecord, RunCancelled> {
    |program, number| made(manifest, (program, number), &mut until(stop))
}

fn made(
    manifest: &Manifest,
    (program, number): (usize, u64),
    watch: &mut impl stochc_runtime::Watch,
) -> Result<RunRecord, RunCancelled> {
    let program = &manifest.programs[program];
    let settings = manifest.settings_of(program);
    let record = program.run(&settings, (manifest.seed, number), watch);
    // The scene has been tried out, so only a cancelled run leaves no record.
    record.map_err(|_| RunCancelled)
}

/// Sets the scenes of programs up once, so that one that cannot be is told of before the first run.
///
/// # Errors
/// If one cannot be.
pub fn try_out_all(manifest: &Manifest) -> Result<(), Failure> {
    let mut programs = manifest.programs.iter();
    programs.try_for_each(|program| {
        (program.try_out(&manifest.settings_of(program)))
            .map_err(|error| Failure::invalid_program(format!("{}: {error}", program.name)))
    })
}

/// Says that runs are added to those of another build, or made again, if they are.
pub(crate) fn warn_of_build(builds: &[String], host: &dyn Host) {
    if let Some(told) = other_build(builds) {
        host.warn(&format!("warning: {told}\n"));
    }
}

/// Says what has become of checkpoints.
pub(crate) fn warn_of_checkpoints(checkpoints: Option<&Checkpoints>, host: &dyn Host) {
    for note in checkpoints.map(Checkpoints::notes).unwrap_or_default() {
        host.warn(&format!("note: {note}\n"));
    }
}

/// How many runs to do at the same time; unasked, as many as there are cores.
pub fn threads(asked: Option<u16>) -> NonZeroUsize {
    let cores = || std::thread::available_parallelism().ok();
    let threads = asked.map_or_else(cores, |asked| NonZeroUsize::new(asked.into()));
    threads.unwrap_or(NonZeroUsize::MIN)
}
