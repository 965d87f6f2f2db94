//! Runs on several threads.
use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use stochc_ir::record::{Outcome, RunRecord};

use super::board::{Board, Watch};
use super::{Finished, Manifest};

/// A run was told to stop by [`Watch::tick`], and leaves nothing behind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

/// A run that is to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Job {
    program: usize,
    run: u64,
}

/// The runs that are not among `kept`: the first run of each program, then the second, and so on,
/// so that a table compares the programs fairly at any time.
pub(super) fn jobs(manifest: &Manifest, kept: &[Finished]) -> impl Iterator<Item = Job> + Send {
    let done: BTreeSet<_> = kept
        .iter()
        .map(|done| (done.record.run, done.program))
        .collect();
    (0..manifest.runs)
        .flat_map(|run| (0..manifest.programs.len()).map(move |program| Job { program, run }))
        .filter(move |job| !done.contains(&(job.run, job.program)))
}

/// Does `jobs` with one thread for each worker of the board, until they are done or `stop` is set.
///
/// `simulate` is called with the program and the number of a run; a panic in it makes that run
/// [`Outcome::Failed`]. `keep` gets every finished run at once. The result is sorted by program
/// and run.
///
/// # Errors
/// The first that `keep` meets, which stops the others.
pub(super) fn execute<E: Send>(
    jobs: impl Iterator<Item = Job> + Send,
    board: &Board,
    stop: &AtomicBool,
    simulate: impl Fn(usize, u64, &Watch) -> Result<RunRecord, Cancelled> + Sync,
    keep: impl Fn(&Finished) -> Result<(), E> + Sync,
) -> Result<Vec<Finished>, E> {
    // Nobody says that they can all be counted, let alone kept.
    let jobs = Mutex::new(jobs);
    let next = || jobs.lock().expect("nobody panics while it is held").next();
    let broken = AtomicBool::new(false);
    let results = Mutex::new((Vec::new(), None));
    let work = |worker| {
        while !stop.load(Ordering::Relaxed) && !broken.load(Ordering::Relaxed) {
            let Some(job) = next() else {
                break;
            };
            let watch = board.begin(worker, job.program, [stop, &broken]);
            let finished = attempt(job, &watch, &simulate);
            board.end(worker, finished.as_ref());
            let Some(finished) = finished else {
                break;
            };
            let kept = keep(&finished);
            let mut results = results.lock().expect("nobody panics while it is held");
            results.0.push(finished);
            if let Err(error) = kept {
                broken.store(true, Ordering::Relaxed);
                results.1.get_or_insert(error);
            }
        }
    };
    std::thread::scope(|scope| {
        for worker in 0..board.workers() {
            let work = &work;
            scope.spawn(move || work(worker));
        }
    });
    let (mut finished, error) = results.into_inner().expect("every worker has ended well");
    finished.sort_by_key(|done: &Finished| (done.program, done.record.run));
    error.map_or(Ok(finished), Err)
}

/// One run; `None`: it was stopped.
fn attempt(
    job: Job,
    watch: &Watch,
    simulate: &impl Fn(usize, u64, &Watch) -> Result<RunRecord, Cancelled>,
) -> Option<Finished> {
    // What the run was working on is dropped with it, so that nobody sees it half done.
    let result = catch_unwind(AssertUnwindSafe(|| {
        let result = simulate(job.program, job.run, watch);
        if let Ok(record) = &result {
            assert_eq!(record.run, job.run, "the record is of another run");
        }
        result
    }));
    let record = match result {
        Ok(Ok(record)) => record,
        Ok(Err(Cancelled)) => return None,
        Err(panic) => {
            let text = panic
                .downcast_ref::<String>()
                .map(String::as_str)
                .or_else(|| panic.downcast_ref::<&str>().copied())
                .unwrap_or("no message");
            let (ticks, phase) = watch.last();
            RunRecord {
                run: job.run,
                outcome: Outcome::Failed {
                    phase,
                    reason: format!("panicked: {text}"),
                },
                ticks,
                phase_ticks: Vec::new(),
                blocks_used: 0,
                hops: 0,
                unplanned: 0,
                bonds: Vec::new(),
                waiting: Vec::new(),
                releases: Vec::new(),
                unplanned_bonds: Vec::new(),
            }
        }
    };
    Some(Finished {
        program: job.program,
        record,
    })
}
