//! The folder of an ensemble: who may write to it, and what it holds already.
//!
//! | file | what |
//! |---|---|
//! | `manifest.json` | what the ensemble depends on |
//! | `journal.jsonl` | every finished run, in the order of finishing |
//! | `runs.parquet`, `phases.parquet`, `bonds.parquet`, `releases.parquet`, `unplanned.parquet` | the same as tables, in the order of program and run; see `docs/results.md` |
//! | `recordings/` | runs to watch; see [`crate::recording`] |
//! | `.lock` | held by the process that writes |
//!
//! Nothing in it is ever replaced by the results of another ensemble.
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use stochc_files as files;
use stochc_files::atomic::{self, Replaces};

use super::build::UNKNOWN;
use super::folder_error::FolderError;
use super::journal::{self, Finished, Journal, JournalError};
use super::manifest::{FORMAT, Manifest};
use super::parquet;

pub(super) const MANIFEST: &str = "manifest.json";
const JOURNAL: &str = "journal.jsonl";
const LOCK: &str = ".lock";
/// The folder within it for recordings.
pub const RECORDINGS: &str = "recordings";

/// A results folder that belongs to this process until it is dropped.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    manifest: Manifest,
    /// That made the runs it holds.
    builds: Vec<String>,
    state: State,
    kept: Vec<Finished>,
    whole: u64,
    /// Unlocked by the system when it is closed, also by a kill.
    _lock: File,
}

/// What an opened folder is good for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// It was empty or absent.
    New,
    /// Some runs are done, and some are not.
    Resumed,
    /// Every run is done: there is nothing to simulate.
    Finished,
}

impl Folder {
    /// Opens the folder at `path` for the ensemble of `manifest`, and makes it if it is not there.
    ///
    /// `resume` goes on with an ensemble that is not finished, or adds runs to one that has fewer
    /// than `manifest` asks for.
    ///
    /// # Errors
    /// Every refusal leaves the folder as it was; its message says the way out.
    pub fn open(path: &Path, manifest: &Manifest, resume: bool) -> Result<Folder, FolderError> {
        let io = |source| FolderError::Io {
            path: path.to_owned(),
            source,
        };
        // Before anything is created: the folder may be somebody else's.
        survey(path)?;
        atomic::make_folder(path).map_err(io)?;
        let lock = lock(path)?;
        // Again, now that nobody else can change the answer.
        let Some(stored) = survey(path)? else {
            replace(path, MANIFEST, manifest.to_json().as_bytes())?;
            return Ok(Folder {
                path: path.to_owned(),
                manifest: manifest.clone(),
                builds: manifest.builds.clone(),
                state: State::New,
                kept: Vec::new(),
                whole: 0,
                _lock: lock,
            });
        };
        if stored.identity() != manifest.identity() {
            return Err(FolderError::Another {
                path: path.to_owned(),
                differences: stored.differences(manifest),
            });
        }
        if stored.runs > manifest.runs {
            return Err(FolderError::MoreRuns {
                path: path.to_owned(),
                there: stored.runs,
                asked: manifest.runs,
            });
        }
        let (kept, whole) = journal::read(&path.join(JOURNAL), &manifest.identity())?;
        let kept = within(manifest, kept);
        let (done, total) = (kept.len() as u64, manifest.total());
        if done < total && !resume {
            return Err(FolderError::Unfinished {
                path: path.to_owned(),
                done,
                total,
            });
        }
        atomic::clear_partial(path).map_err(io)?;
        let recordings = path.join(RECORDINGS);
        if recordings.is_dir() {
            atomic::clear_partial(&recordings).map_err(io)?;
        }
        let mut manifest = manifest.clone();
        manifest.builds = match done == total {
            true => stored.builds.clone(),
            false => joined(&stored.builds, &manifest.builds),
        };
        if stored.runs < manifest.runs || stored.builds != manifest.builds {
            replace(path, MANIFEST, manifest.to_json().as_bytes())?;
        }
        Ok(Folder {
            path: path.to_owned(),
            manifest,
            builds: stored.builds,
            state: if done == total {
                State::Finished
            } else {
                State::Resumed
            },
            kept,
            whole,
            _lock: lock,
        })
    }

    /// Reads the ensemble at `path`, finished or not, without a lock and without changing it.
    ///
    /// The runs are sorted by program and run.
    ///
    /// # Errors
    /// When there is no ensemble, or it cannot be read.
    pub fn read(path: &Path) -> Result<(Manifest, Vec<Finished>), FolderError> {
        let absent = || FolderError::Absent(path.to_owned());
        let manifest = match survey(path) {
            Err(FolderError::NotResults(_) | FolderError::NotAFolder(_)) => None,
            surveyed => surveyed?,
        };
        let manifest = manifest.ok_or_else(absent)?;
        let (kept, _) = journal::read(&path.join(JOURNAL), &manifest.identity())?;
        let kept = within(&manifest, kept);
        Ok((manifest, kept))
    }

    /// What the folder was opened for.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// The builds of `stochc` that made the runs it holds.
    pub fn builds(&self) -> &[String] {
        &self.builds
    }

    /// What is left to do.
    pub fn state(&self) -> State {
        self.state
    }

    /// The runs that were done when it was opened, sorted by program and run.
    pub fn kept(&self) -> &[Finished] {
        &self.kept
    }

    /// Opens the journal for the runs that are still to be done; once, since it begins where the
    /// journal ended when the folder was opened.
    ///
    /// # Errors
    /// Those of the file system.
    pub(super) fn journal(&self) -> Result<Journal, JournalError> {
        let identity = self.manifest.identity();
        let journal = Journal::open(&self.path.join(JOURNAL), &identity, self.whole)?;
        atomic::sync_folder(&self.path)?;
        Ok(journal)
    }

    /// Writes the tables from runs sorted by program and run.
    ///
    /// # Errors
    /// Those of the file system.
    pub(super) fn write_tables(&self, finished: &[Finished]) -> Result<(), FolderError> {
        for (name, table) in parquet::files(&self.manifest, finished) {
            replace(&self.path, &name, &table)?;
        }
        Ok(())
    }
}

/// Reads the manifest of a folder; `None`: there is no folder, or nothing of anybody's in it.
fn survey(path: &Path) -> Result<Option<Manifest>, FolderError> {
    let io = |source| FolderError::Io {
        path: path.to_owned(),
        source,
    };
    let unreadable = |reason| FolderError::Unreadable {
        path: path.to_owned(),
        reason,
    };
    let entries = match fs::read_dir(path) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) if error.kind() == io::ErrorKind::NotADirectory => {
            return Err(FolderError::NotAFolder(path.to_owned()));
        }
        Err(error) => return Err(io(error)),
    };
    let mut foreign = false;
    for entry in entries {
        let name = entry.map_err(io)?.file_name();
        if name == MANIFEST {
            let bytes = files::read_file(&path.join(MANIFEST)).map_err(io)?;
            let json = String::from_utf8(bytes).map_err(|error| unreadable(error.to_string()))?;
            if (1..FORMAT).contains(&Manifest::format(&json).map_err(unreadable)?) {
                let path = path.to_owned();
                return Err(FolderError::Old { path });
            }
            return Manifest::from_json(&json).map(Some).map_err(unreadable);
        }
        foreign |= name != LOCK && !name.to_string_lossy().starts_with(atomic::PARTIAL);
    }
    if foreign {
        return Err(FolderError::NotResults(path.to_owned()));
    }
    Ok(None)
}

fn lock(path: &Path) -> Result<File, FolderError> {
    let io = |source| FolderError::Io {
        path: path.to_owned(),
        source,
    };
    let mut options = File::options();
    let options = options.create(true).truncate(false).write(true);
    let file = files::open_own(&path.join(LOCK), options).map_err(io)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(FolderError::Locked(path.to_owned())),
        Err(TryLockError::Error(error)) => Err(io(error)),
    }
}

/// Writes a file of a folder of results, in the place of an earlier one.
fn replace(path: &Path, name: &str, content: &[u8]) -> Result<(), FolderError> {
    let path = path.join(name);
    atomic::replace(&path, content, Replaces::Ordinary)
        .map_err(|source| FolderError::Io { path, source })
}

/// The builds of a folder, after one more has made runs.
fn joined(stored: &[String], here: &[String]) -> Vec<String> {
    let mut all = match stored {
        [] => vec![UNKNOWN.to_owned()],
        stored => stored.to_vec(),
    };
    for build in here {
        if !all.contains(build) {
            all.push(build.clone());
        }
    }
    all
}

/// Leaves out runs that the manifest does not ask for.
fn within(manifest: &Manifest, mut kept: Vec<Finished>) -> Vec<Finished> {
    kept.retain(|done| done.program < manifest.programs.len() && done.record.run < manifest.runs);
    kept
}
