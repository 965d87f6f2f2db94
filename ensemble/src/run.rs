//! The whole road of an ensemble: what is left to do, doing it, keeping it.
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use stochc_ir::record::{Outcome, RunRecord};

use super::executor::{Cancelled, attempt, execute};
use super::journal::Journal;
use super::progress::{Progress, Watch};
use super::{Finished, Folder, FolderError, JournalError, Manifest};

/// Where the runs of an ensemble go.
#[allow(
    clippy::large_enum_variant,
    reason = "there is one of them in a process"
)]
#[derive(Debug)]
pub enum Destination<'a> {
    /// Nowhere: they are gone with the process.
    Memory(&'a Manifest),
    /// Into a folder, which may hold some already; it is released in the end.
    Folder(Folder),
}

impl Destination<'_> {
    /// How many runs there are already.
    pub fn kept(&self) -> u64 {
        match self {
            Destination::Memory(_) => 0,
            Destination::Folder(folder) => folder.kept().len() as u64,
        }
    }
}

/// What there is in the end.
#[derive(Clone, Debug, PartialEq)]
pub struct Results {
    /// Finished runs, sorted by program and run; those that were there before included.
    pub finished: Vec<Finished>,
    /// Whether these are all of the manifest's runs; if not, it was stopped.
    pub complete: bool,
}

/// Why an ensemble came to no end.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// Finished runs cannot be kept; what the journal holds is safe.
    #[error(transparent)]
    Journal(#[from] JournalError),
    /// The tables cannot be written; the journal holds every finished run.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// A run does not come out as it is stored.
    #[error(
        "run {run} of `{program}` does not come out as it is in the folder, so that other runs are not added to it; go on \
         with the `stochc` that made it, on a machine of the same kind, or choose another folder"
    )]
    Differs {
        /// The name of its program.
        program: String,
        /// Its number.
        run: u64,
    },
}

/// Makes the shortest run of a folder again, before others are added to it; whether it comes out as it was, or `stop`
/// came before.
///
/// # Errors
/// [`RunError::Differs`]; the folder is as it was then.
pub fn check_stored(
    folder: &Folder,
    simulate: impl FnOnce(usize, u64) -> Result<RunRecord, Cancelled>,
) -> Result<(), RunError> {
    let sound = |done: &&Finished| !matches!(done.record.outcome, Outcome::Failed { .. });
    let kept = folder.kept().iter().filter(sound);
    let Some(known) = kept.min_by_key(|done| done.record.ticks) else {
        return Ok(());
    };
    match simulate(known.program, known.record.run) {
        Ok(record) if record != known.record => Err(RunError::Differs {
            program: folder.manifest().programs[known.program].name.clone(),
            run: record.run,
        }),
        _ => Ok(()),
    }
}

/// A run that is to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Job {
    program: usize,
    run: u64,
}

/// Does the runs of an ensemble that are not done yet, and writes its tables.
///
/// `simulate` gets the index of a program, the number of a run, and a [`Watch`] to call once a
/// tick. It has to be a pure function of the first two, so that neither threads nor interruptions
/// nor their order change a byte of the tables. A panic in it fails that one run. `progress` is to be a new one of
/// the same manifest, and says how many threads there are; `stop` is set by somebody else to stop at the next tick.
///
/// # Errors
/// Only those of the file system: never with [`Destination::Memory`].
pub fn run(
    destination: Destination,
    progress: &Progress,
    stop: &AtomicBool,
    simulate: impl Fn(usize, u64, &Watch) -> Result<RunRecord, Cancelled> + Sync,
) -> Result<Results, RunError> {
    let (manifest, kept) = match &destination {
        Destination::Memory(manifest) => (*manifest, &[][..]),
        Destination::Folder(folder) => (folder.manifest(), folder.kept()),
    };
    progress.keep(kept);
    let mut finished = kept.to_vec();
    if manifest.total() > kept.len() as u64 {
        let journal = match &destination {
            Destination::Memory(_) => None,
            Destination::Folder(folder) => Some(folder.journal()?),
        };
        let done = new_runs(manifest, kept, progress, stop, simulate, |done| {
            journal
                .as_ref()
                .map_or(Ok(()), |journal| journal.append(done))
        });
        // The writer knows better what went wrong than those whom it left alone.
        journal.map_or(Ok(()), Journal::close)?;
        finished.extend(done?);
        finished.sort_by_key(|done| (done.program, done.record.run));
    }
    if let Destination::Folder(folder) = &destination {
        folder.write_tables(&finished)?;
    }
    Ok(Results {
        complete: finished.len() as u64 == manifest.total(),
        finished,
    })
}

/// Makes the runs that are not among `kept`, and has each kept at once; the first error of that stops the others.
fn new_runs<E: Send>(
    manifest: &Manifest,
    kept: &[Finished],
    progress: &Progress,
    stop: &AtomicBool,
    simulate: impl Fn(usize, u64, &Watch) -> Result<RunRecord, Cancelled> + Sync,
    keep: impl Fn(&Finished) -> Result<(), E> + Sync,
) -> Result<Vec<Finished>, E> {
    // Nobody says that they can all be counted, let alone kept.
    let jobs = Mutex::new(jobs(manifest, kept));
    let next = || jobs.lock().expect("nobody panics while it is held").next();
    let left = manifest.total().saturating_sub(kept.len() as u64);
    let threads = usize::try_from(left).map_or(progress.threads(), |it| progress.threads().min(it));
    let broken = AtomicBool::new(false);
    let results = Mutex::new((Vec::new(), None));
    execute(threads, stop, next, |thread, Job { program, run }| {
        if broken.load(Ordering::Relaxed) {
            return ControlFlow::Break(());
        }
        let watch = progress.begin(thread, program, [stop, &broken]);
        let record = attempt(run, || simulate(program, run, &watch), || watch.last());
        let finished = record.map(|record| Finished { program, record });
        progress.end(thread, finished.as_ref());
        let Some(finished) = finished else {
            return ControlFlow::Break(());
        };
        let kept = keep(&finished);
        let mut results = results.lock().expect("nobody panics while it is held");
        results.0.push(finished);
        if let Err(error) = kept {
            broken.store(true, Ordering::Relaxed);
            results.1.get_or_insert(error);
        }
        ControlFlow::Continue(())
    });
    let (finished, error) = results.into_inner().expect("every thread has ended well");
    error.map_or(Ok(finished), Err)
}

/// The first run of each program, then the second, and so on, so that a table compares the programs fairly at any time.
fn jobs(manifest: &Manifest, kept: &[Finished]) -> impl Iterator<Item = Job> + Send {
    let done: BTreeSet<_> = kept
        .iter()
        .map(|done| (done.record.run, done.program))
        .collect();
    (0..manifest.runs)
        .flat_map(|run| (0..manifest.programs.len()).map(move |program| Job { program, run }))
        .filter(move |job| !done.contains(&(job.run, job.program)))
}
