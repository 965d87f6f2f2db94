//! Execution of an ensemble: makes the missing runs and stores them.
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use stochc_ir::record::RunRecord;

use crate::execution::thread_time;
use crate::execution::{PendingRun, PendingRuns};
use crate::execution::{Progress, RunWatch};
use crate::execution::{RunCancelled, attempt, execute};
use crate::journal::Journal;
use crate::records::LineLocation;
use crate::{Checkpoints, Finished, Folder, FolderError, JournalError, Manifest, Records};

/// Destination of an ensemble's runs.
#[allow(
    clippy::large_enum_variant,
    reason = "there is one of them in a process"
)]
#[derive(Debug)]
pub enum Destination<'a> {
    /// Keeps the results in memory only.
    Memory(&'a Manifest),
    /// Adds runs to results in memory.
    MoreInMemory(&'a Manifest, Records),
    /// Stores the results in a folder, which may contain some runs already. The folder is closed at
    /// the end.
    Folder(Folder),
}

impl Destination<'_> {
    /// Returns the number of runs that already exist.
    pub fn existing(&self) -> u64 {
        match self {
            Destination::Memory(_) => 0,
            Destination::MoreInMemory(_, existing) => existing.len() as u64,
            Destination::Folder(folder) => folder.existing().len() as u64,
        }
    }
}

/// Results of an ensemble.
#[derive(Debug)]
pub struct Results {
    /// Finished runs, including earlier ones.
    pub finished: Records,
    /// Whether all runs of the manifest are finished.
    pub complete: bool,
}

/// Error of running an ensemble.
#[derive(Debug, thiserror::Error)]
pub enum EnsembleError {
    /// Finished runs cannot be stored. The journal's content is safe.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The tables cannot be written. The journal contains every finished run.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// A repeated run differs from the stored one.
    #[error(
        "run {run} of `{program}` does not come out as it is in the folder, so that other runs are not added to it; go on \
         with the `stochc` that made it, on a machine of the same kind, or choose another folder"
    )]
    Differs {
        /// Name of the program whose run differs.
        program: String,
        /// Number of the run that differs.
        run: u64,
    },
}

/// Repeats the shortest run of a folder and compares the records, before other runs are added.
///
/// # Errors
///
/// [`EnsembleError::Differs`]. The folder is then unchanged.
pub fn check_stored(
    folder: &Folder,
    simulate: impl FnOnce(usize, u64) -> Result<RunRecord, RunCancelled>,
) -> Result<(), EnsembleError> {
    check_again(folder.manifest(), folder.shortest(), simulate)
}

/// Repeats a `known` run and compares the records.
pub(crate) fn check_again(
    manifest: &Manifest,
    known: Option<&Finished>,
    simulate: impl FnOnce(usize, u64) -> Result<RunRecord, RunCancelled>,
) -> Result<(), EnsembleError> {
    let Some(known) = known else {
        return Ok(());
    };
    match simulate(known.program, known.record.run) {
        Ok(record) if record != known.record => Err(EnsembleError::Differs {
            program: manifest.programs[known.program].name.clone(),
            run: record.run,
        }),
        _ => Ok(()),
    }
}

/// Makes the missing runs of an ensemble, and writes its tables.
///
/// `simulate` receives the index of a program, the number of a run, and a [`RunWatch`] to call once
/// per tick. It must be a pure function of index and number. The tables then do not depend on
/// threads or interruptions, or on the order of the runs. A panic in `simulate` fails only its run.
/// `progress` must be new and of the same manifest. It sets the number of threads. Setting `stop`
/// ends the work at the next tick.
///
/// # Errors
///
/// Errors of the file system. None with [`Destination::Memory`].
pub fn run(
    destination: Destination,
    progress: &Progress,
    stop: &AtomicBool,
    simulate: impl Fn(usize, u64, &RunWatch) -> Result<RunRecord, RunCancelled> + Sync,
) -> Result<Results, EnsembleError> {
    match destination {
        Destination::Memory(manifest) => {
            let destination = Destination::MoreInMemory(manifest, Records::default());
            run(destination, progress, stop, simulate)
        }
        Destination::MoreInMemory(manifest, existing) => {
            progress.count_existing(&existing)?;
            let all = Mutex::new(existing.to_vec()?);
            let store = |done| {
                all.lock().expect("no code panics with the lock").push(done);
                Ok::<(), Infallible>(())
            };
            let pending = PendingRuns::all(manifest, 0..manifest.total(), Some(&existing));
            let tracker = RunTracker {
                progress,
                checkpoints: None,
            };
            let Ok(()) = new_runs(pending, tracker, stop, simulate, store);
            let all = all.into_inner().expect("no thread has panicked");
            Ok(Results::from_records(manifest, all.into()))
        }
        Destination::Folder(mut folder) => {
            folder.leave_foul_lines()?;
            progress.count_existing(folder.existing())?;
            let (manifest, existing) = (folder.manifest(), folder.existing());
            let pending = PendingRuns::all(manifest, 0..manifest.total(), Some(existing));
            let finished = match pending.left {
                0 => None,
                _ => {
                    let journal = folder.journal()?;
                    let tracker = RunTracker {
                        progress,
                        checkpoints: folder.checkpoints().map(Arc::as_ref),
                    };
                    let locations = journaled(pending, journal, 0, tracker, stop, simulate)?;
                    Some(folder.records([existing.locations(), &locations].concat())?)
                }
            };
            let known = finished.as_ref().unwrap_or(existing);
            folder.clear_checkpoints(known)?;
            folder.write_tables(known)?;
            let (manifest, existing) = folder.close();
            Ok(Results::from_records(
                &manifest,
                finished.unwrap_or(existing),
            ))
        }
    }
}

impl Results {
    fn from_records(manifest: &Manifest, finished: Records) -> Results {
        Results {
            complete: finished.len() as u64 == manifest.total(),
            finished,
        }
    }
}

#[derive(Clone, Copy)]
pub(crate) struct RunTracker<'a> {
    pub progress: &'a Progress,
    pub checkpoints: Option<&'a Checkpoints>,
}

/// Makes the pending runs and appends each to a journal. Returns the positions of the lines. `file`
/// is the index of the journal file.
pub(crate) fn journaled(
    pending: PendingRuns,
    journal: Journal,
    file: u32,
    tracker: RunTracker<'_>,
    stop: &AtomicBool,
    simulate: impl Fn(usize, u64, &RunWatch) -> Result<RunRecord, RunCancelled> + Sync,
) -> Result<Vec<LineLocation>, JournalError> {
    let locations = Mutex::new(Vec::new());
    let store = |done: Finished| {
        let location = done.at(file, journal.append(&done)?);
        if let Some(checkpoints) = tracker.checkpoints {
            checkpoints.remove(done.program, done.record.run, || journal.sync())?;
        }
        let mut locations = locations.lock().expect("no panic while it is locked");
        locations.push(location);
        Ok(())
    };
    let done: Result<(), JournalError> = new_runs(pending, tracker, stop, simulate, store);
    // The error of the writer itself is more specific than the errors that result from it.
    journal.close()?;
    done?;
    Ok(locations.into_inner().expect("no thread has panicked"))
}

/// Makes runs and stores each at once. The first storage error stops the other runs.
fn new_runs<E: Send>(
    pending: PendingRuns,
    RunTracker {
        progress,
        checkpoints,
    }: RunTracker<'_>,
    stop: &AtomicBool,
    simulate: impl Fn(usize, u64, &RunWatch) -> Result<RunRecord, RunCancelled> + Sync,
    store: impl Fn(Finished) -> Result<(), E> + Sync,
) -> Result<(), E> {
    let left = pending.left;
    let jobs = Mutex::new(pending.iter());
    let next = || {
        let mut jobs = jobs.lock().expect("no panic while it is locked");
        if progress.is_over() {
            None
        } else {
            jobs.next()
        }
    };
    let threads = usize::try_from(left).map_or(progress.threads(), |it| progress.threads().min(it));
    let broken = AtomicBool::new(false);
    let first = Mutex::new(None);
    execute(threads, stop, next, |thread, job| {
        if broken.load(Ordering::Relaxed) {
            return ControlFlow::Break(());
        }
        let PendingRun { program, run } = job;
        let watch = progress.begin(thread, job, [stop, &broken], checkpoints);
        let begun = thread_time();
        let make = || attempt(run, || simulate(program, run, &watch), || watch.last());
        let mut record = make();
        if watch.begins_anew(record.as_ref()) {
            record = make();
        }
        let is_measured = progress.measures_cpu && !watch.is_continued();
        let cpu = is_measured.then(|| thread_time().saturating_sub(begun));
        let finished = record.map(|record| Finished {
            program,
            record,
            cpu: cpu.map(|cpu| cpu.as_micros() as f64 / 1e6),
        });
        progress.end(thread, finished.as_ref());
        let Some(finished) = finished else {
            return ControlFlow::Break(());
        };
        if let Err(error) = store(finished) {
            broken.store(true, Ordering::Relaxed);
            let mut first = first.lock().expect("no panic while it is locked");
            first.get_or_insert(error);
        }
        ControlFlow::Continue(())
    });
    let error = first.into_inner().expect("no thread has panicked");
    error.map_or(Ok(()), Err)
}
