//! Ensembles whose results stay in memory.
use stochc_results::{
    Destination, Manifest, Progress, Results, RunCancelled, RunWatch, run as run_all,
};

use super::runs::{threads as default_threads, try_out_all};
use crate::exit::{Exit, Failure};
use crate::host::{Host, during};
use crate::progress::work_progress;

/// Makes all runs of a manifest. Each program gets its own seed, because equal random impulses
/// would correlate the errors of programs.
///
/// # Errors
/// If a scene cannot be set up, or the user interrupts. The message about an interrupt includes
/// `stopped`.
pub fn all_runs(
    manifest: &Manifest,
    threads: Option<u16>,
    stopped: &str,
    host: &dyn Host,
) -> Result<Results, Failure> {
    try_out_all(manifest)?;
    let progress = Progress::new(manifest, default_threads(threads));
    let simulate = |entry: usize, number, watch: &RunWatch| {
        let program = &manifest.programs[entry];
        let mut watcher = |tick, phase| watch.tick(tick, phase);
        let seed = manifest.seed.wrapping_add(entry as u64);
        let record = program.run(&manifest.settings_of(program), seed, number, &mut watcher);
        record.map_err(|_| RunCancelled)
    };
    let state = |elapsed| work_progress(manifest, &progress, elapsed);
    let destination = Destination::Memory(manifest);
    let results = during(host, state, || {
        run_all(destination, &progress, host.stop(), simulate)
    })
    .map_err(Failure::usage)?;
    if results.complete {
        Ok(results)
    } else {
        Err(self::stopped(stopped))
    }
}

/// Returns the failure of an interrupted command. `what` describes the consequence.
pub fn stopped(what: &str) -> Failure {
    Failure {
        exit: Exit::Interrupted,
        message: format!("stopped; {what}\n"),
    }
}
