//! The whole road of an ensemble: what is left to do, doing it, keeping it.
use std::num::NonZeroUsize;
use std::sync::atomic::AtomicBool;

use stochc_ir::record::RunRecord;

use super::board::{Board, Watch};
use super::execute::{Cancelled, execute, jobs};
use super::journal::Journal;
use super::progress::{Display, during};
use super::{Finished, Folder, FolderError, JournalError, Manifest};

/// Where the runs of an ensemble go.
#[allow(
    clippy::large_enum_variant,
    reason = "there is one of them in a process"
)]
#[derive(Debug)]
pub enum Place<'a> {
    /// Nowhere: they are gone with the process.
    Memory(&'a Manifest),
    /// Into a folder, which may hold some already; it is released in the end.
    Folder(Folder),
}

/// How to do it; no result depends on it.
#[derive(Clone, Copy, Debug)]
pub struct Means<'a> {
    /// Runs at the same time.
    pub threads: NonZeroUsize,
    /// What to show meanwhile.
    pub display: Display,
    /// Set by somebody else to stop at the next tick; see
    /// [`stop_on_interrupt`](super::stop_on_interrupt).
    pub stop: &'a AtomicBool,
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
}

/// Does the runs of an ensemble that are not done yet, and writes its tables.
///
/// `simulate` gets the index of a program, the number of a run, and a [`Watch`] to call once a
/// tick. It has to be a pure function of the first two, so that neither threads nor interruptions
/// nor their order change a byte of the tables. A panic in it fails that one run.
///
/// # Errors
/// Only those of the file system: never with [`Place::Memory`].
pub fn run(
    place: Place,
    means: Means,
    simulate: impl Fn(usize, u64, &Watch) -> Result<RunRecord, Cancelled> + Sync,
) -> Result<Results, RunError> {
    let (manifest, kept) = match &place {
        Place::Memory(manifest) => (*manifest, &[][..]),
        Place::Folder(folder) => (folder.manifest(), folder.kept()),
    };
    let left = manifest.total().saturating_sub(kept.len() as u64);
    let mut finished = kept.to_vec();
    if left > 0 {
        let journal = match &place {
            Place::Memory(_) => None,
            Place::Folder(folder) => Some(folder.journal()?),
        };
        let threads =
            usize::try_from(left).map_or(means.threads.get(), |left| means.threads.get().min(left));
        let board = Board::new(manifest, kept, threads);
        let jobs = jobs(manifest, kept);
        let executed = during(means.display, manifest, &board, || {
            execute(jobs, &board, means.stop, simulate, |done| match &journal {
                Some(journal) => journal.append(done),
                None => Ok(()),
            })
        });
        // The writer knows better what went wrong than those whom it left alone.
        journal.map_or(Ok(()), Journal::close)?;
        finished.extend(executed?);
        finished.sort_by_key(|done| (done.program, done.record.run));
    }
    if let Place::Folder(folder) = &place {
        folder.write_tables(&finished)?;
    }
    Ok(Results {
        complete: finished.len() as u64 == manifest.total(),
        finished,
    })
}
