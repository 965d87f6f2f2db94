//! Report of a results folder that is rewritten during the runs (`--watch`).
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;

use stochc_report::figures::Figures;
use stochc_results::now;

use super::report::write_of_one;
use crate::exit::Failure;
use crate::host::Host;

/// Shortest time between two versions of the report. The browser reloads the page at the same
/// interval.
const SHORTEST_PAUSE: Duration = Duration::from_secs(5);
/// Reciprocal of the largest fraction of time that may be spent on writing reports.
const SHARE: u32 = 20;

/// Runs `work`, which adds runs to a folder. Rewrites the report during the work and at its end.
///
/// # Errors
/// If the report cannot be written before the work starts.
pub(super) fn watched<R>(
    folder: &Path,
    figures: &Figures,
    host: &dyn Host,
    work: impl FnOnce() -> R,
) -> Result<R, Failure> {
    let page = write_of_one(folder, figures, Some(SHORTEST_PAUSE))?;
    host.note(&format!("report of the runs so far: {}\n", page.display()));
    let done = std::thread::scope(|scope| {
        // The sender is dropped when the work ends, even by a panic.
        let (_working, ended) = channel();
        let rewrite = move || rewrite(folder, figures, &ended);
        // If the thread cannot be started, the report is written only at the end.
        let _ = std::thread::Builder::new().spawn_scoped(scope, rewrite);
        work()
    });
    if let Err(failure) = write_of_one(folder, figures, None) {
        host.report_failure(&failure.message);
    }
    Ok(done)
}

/// Rewrites the report until the channel `ended` closes. The pause grows with the time that writing
/// takes.
fn rewrite(folder: &Path, figures: &Figures, ended: &Receiver<()>) {
    let mut pause = SHORTEST_PAUSE;
    while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(pause) {
        let begun = now();
        // An error is ignored here. Writing the report at the end returns it.
        let _ = write_of_one(folder, figures, Some(pause));
        pause = SHORTEST_PAUSE.max(begun.elapsed() * SHARE);
    }
}
