//! Runs on several threads.
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};

use stochc_ir::record::{Outcome, RunRecord};
use stochc_ir::table::PhaseId;

/// A run was told to stop, and leaves nothing behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunCancelled;

/// Has each of so many threads do one job after the other, until `next` has none left or `stop` is set. One of them is
/// that of the caller, and fewer have to do where the system has no more.
///
/// `work` gets the number of its thread, from 0, and says whether to go on.
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

/// How the reason begins for which a run has failed that panicked.
const PANICKED: &str = "panicked: ";

/// Whether a run failed by a panic.
pub(crate) fn is_panic(record: &RunRecord) -> bool {
    matches!(&record.outcome, Outcome::Failed { reason, .. } if reason.starts_with(PANICKED))
}

/// Makes a run; `None`: it was stopped. A panic in it makes it [`Outcome::Failed`], where `last` says that it was.
pub(crate) fn attempt(
    run: u64,
    simulate: impl FnOnce() -> Result<RunRecord, RunCancelled>,
    last: impl FnOnce() -> (u64, PhaseId),
) -> Option<RunRecord> {
    // What the run was working on is dropped with it, so that nobody sees it half done.
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
            };
            Some(RunRecord::without_bonds(run, outcome, ticks))
        }
    }
}
