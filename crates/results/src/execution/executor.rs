//! Execution of runs on several threads.
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

use stochc_ir::record::{Outcome, RunRecord};
use stochc_ir::table::PhaseId;

/// A run was cancelled and leaves no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunCancelled;

/// Processes jobs on `threads` threads until `next` returns `None` or `stop` is set. The calling
/// thread is one of them. Uses fewer threads if the system cannot start more.
///
/// `work` receives the index of its thread, from 0, and returns whether to continue.
pub(crate) fn execute<J>(
    threads: usize,
    stop: &AtomicBool,
    next: impl Fn() -> Option<J> + Sync,
    work: impl Fn(usize, J) -> ControlFlow<()> + Sync,
) {
    let thread = |number| {
        while !stop.load(Ordering::Relaxed) {
            let Some(job) = next() else { break };
            if work(number, job).is_break() {
                break;
            }
        }
    };
    std::thread::scope(|scope| {
        for number in 1..threads {
            let thread = &thread;
            let builder = std::thread::Builder::new();
            if builder.spawn_scoped(scope, move || thread(number)).is_err() {
                break;
            }
        }
        thread(0);
    });
}

const PANICKED: &str = "panicked: ";

/// Returns whether a run failed because it panicked.
pub(crate) fn is_panic(record: &RunRecord) -> bool {
    matches!(&record.outcome, Outcome::Failed { reason, .. } if reason.starts_with(PANICKED))
}

/// Makes a run, or returns `None` if it was cancelled. A panic becomes [`Outcome::Failed`] at the
/// tick and phase that `last` returns.
pub(crate) fn attempt(
    run: u64,
    simulate: impl FnOnce() -> Result<RunRecord, RunCancelled>,
    last: impl FnOnce() -> (u64, PhaseId),
) -> Option<RunRecord> {
    // The partial state of the run is dropped and never observed after a panic.
    let result = catch_unwind(AssertUnwindSafe(|| {
        let result = simulate();
        if let Ok(record) = &result {
            assert_eq!(record.run, run, "the record is of another run");
        }
        result
    }));
    match result {
        Ok(Ok(record)) => Some(record),
        Ok(Err(RunCancelled)) => None,
        Err(panic) => {
            let text = panic
                .downcast_ref::<String>()
                .map(String::as_str)
                .or_else(|| panic.downcast_ref::<&str>().copied())
                .unwrap_or("no message");
            let (ticks, phase) = last();
            let outcome = Outcome::Failed {
                phase,
                reason: format!("{PANICKED}{text}"),
                is_broken: false,
            };
            Some(RunRecord::without_bonds(run, outcome, ticks))
        }
    }
}
