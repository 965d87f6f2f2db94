//! The folder of an ensemble: who may write to it, and what it holds already.
//!
//! | file | what |
//! |---|---|
//! | `manifest.json` | what the ensemble depends on |
//! | `journal.jsonl` | every finished run, in the order of finishing |
//! | `runs.parquet`, `phases.parquet`, `bonds.parquet`, `releases.parquet`, `unplanned.parquet` | the same as tables, in the order of program and run; see `docs/results.md` |
//! | `recordings/` | runs to watch; see [`crate::recording`] |
//! | `checksums.json` | of the others, when they were last written as a whole; see [`super::seal`] |
//! | `.lock` | held by the process that writes |
//!
//! Nothing in it is ever replaced by the results of another ensemble.
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use stochc_files as files;
use stochc_files::atomic::{self, Replaces};
use stochc_files::budget;

use super::build::{UNKNOWN, other_build};
use super::folder_error::FolderError;
use super::journal::{self, Finished, Journal, JournalError};
use super::manifest::{Manifest, OLDEST};
use super::parquet;
use super::seal::{SEAL, Seal};

pub(super) const MANIFEST: &str = "manifest.json";
pub(super) const JOURNAL: &str = "journal.jsonl";
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
    /// Whether its manifest is not yet the one that it has been opened for.
    is_changed: bool,
    state: State,
    kept: Vec<Finished>,
    whole: u64,
    damage: Vec<String>,
    further: Further,
    /// Unlocked by the system when it is closed, also by a kill.
    _lock: File,
}

/// What makes further files of a folder, by their names, from runs sorted by program and run.
pub type Further = fn(&Manifest, &[Finished]) -> Vec<(String, String)>;

/// What a folder holds, as far as it is sound.
#[derive(Clone, Debug, PartialEq)]
pub struct Contents {
    /// What its ensemble depends on.
    pub manifest: Manifest,
    /// Its runs, sorted by program and run.
    pub finished: Vec<Finished>,
    /// What is wrong with its files, each in a sentence.
    pub damage: Vec<String>,
}

/// Whether to go on with an ensemble that is not finished, or to add runs to one that has fewer than are asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resume {
    /// Not at all.
    No,
    /// If all its runs were made by this build.
    SameBuild,
    /// Whichever builds have made its runs.
    MixedBuilds,
}

impl From<bool> for Resume {
    fn from(resume: bool) -> Resume {
        match resume {
            true => Resume::SameBuild,
            false => Resume::No,
        }
    }
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
    /// # Errors
    /// Every refusal leaves the folder as it was; its message says the way out.
    pub fn open(
        path: &Path,
        manifest: &Manifest,
        resume: impl Into<Resume>,
    ) -> Result<Folder, FolderError> {
        let resume = resume.into();
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
            write_manifest(path, manifest)?;
            return Ok(Folder {
                path: path.to_owned(),
                manifest: manifest.clone(),
                builds: manifest.builds.clone(),
                state: State::New,
                is_changed: false,
                kept: Vec::new(),
                whole: 0,
                damage: Vec::new(),
                further: |_, _| Vec::new(),
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
        let journal = journal::read(&path.join(JOURNAL), manifest, &manifest.identity())?;
        let kept = journal.finished;
        let damage = damage(path, journal.damage);
        let (done, total) = (kept.len() as u64, manifest.total());
        if done < total && resume == Resume::No {
            return Err(FolderError::Unfinished {
                path: path.to_owned(),
                done,
                total,
            });
        }
        // Without a run there is nothing to be mixed with.
        let others = stored.builds != manifest.builds && done > 0;
        if done < total && others && resume != Resume::MixedBuilds {
            return Err(FolderError::OtherBuild {
                path: path.to_owned(),
                reason: other_build(&stored.builds).unwrap_or_default(),
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
        Ok(Folder {
            path: path.to_owned(),
            is_changed: stored.runs < manifest.runs || stored.builds != manifest.builds,
            manifest,
            builds: stored.builds,
            state: if done == total {
                State::Finished
            } else {
                State::Resumed
            },
            kept,
            whole: journal.whole,
            damage,
            further: |_, _| Vec::new(),
            _lock: lock,
        })
    }

    /// Reads the ensemble at `path`, finished or not, without a lock and without changing it.
    ///
    /// # Errors
    /// When there is no ensemble, or it cannot be read.
    pub fn read(path: &Path) -> Result<Contents, FolderError> {
        let absent = || FolderError::Absent(path.to_owned());
        let manifest = match survey(path) {
            Err(FolderError::NotResults(_) | FolderError::NotAFolder(_)) => None,
            surveyed => surveyed?,
        };
        let manifest = manifest.ok_or_else(absent)?;
        let journal = journal::read(&path.join(JOURNAL), &manifest, &manifest.identity())?;
        Ok(Contents {
            manifest,
            finished: journal.finished,
            damage: damage(path, journal.damage),
        })
    }

    /// Has further files written with the tables.
    pub fn with(mut self, further: Further) -> Folder {
        self.further = further;
        self
    }

    /// What was wrong with its files when it was opened, each in a sentence.
    pub fn damage(&self) -> &[String] {
        &self.damage
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
    pub(super) fn journal(&self) -> Result<Journal, FolderError> {
        if self.is_changed {
            write_manifest(&self.path, &self.manifest)?;
        }
        let identity = self.manifest.identity();
        let journal = Journal::open(&self.path.join(JOURNAL), &identity, self.whole)?;
        atomic::sync_folder(&self.path).map_err(JournalError::Io)?;
        Ok(journal)
    }

    /// Writes the tables from runs sorted by program and run, the further files, and at last the checksums of all.
    ///
    /// # Errors
    /// Those of the file system.
    pub(super) fn write_tables(&self, finished: &[Finished]) -> Result<(), FolderError> {
        let further = (self.further)(&self.manifest, finished).into_iter();
        let further = further.map(|(name, text)| (name, text.into_bytes()));
        let tables = parquet::files(&self.manifest, finished).into_iter();
        let files: Vec<_> = tables.chain(further).collect();
        // Tables that are being written are not those that are known.
        seal(&self.path, &self.manifest, &[])?;
        for (name, content) in &files {
            replace(&self.path, name, content)?;
        }
        seal(&self.path, &self.manifest, &files)
    }
}

/// Writes the manifest of a folder, which has no tables of it yet.
pub(super) fn write_manifest(path: &Path, manifest: &Manifest) -> Result<(), FolderError> {
    // What is there is not what is known, until it is sealed again.
    remove(path, SEAL)?;
    replace(path, MANIFEST, manifest.to_json().as_bytes())?;
    seal(path, manifest, &[])
}

/// Writes the checksums of the manifest, of the journal as it is, and of these files.
fn seal(path: &Path, manifest: &Manifest, files: &[(String, Vec<u8>)]) -> Result<(), FolderError> {
    let io = |source| FolderError::Io {
        path: path.to_owned(),
        source,
    };
    let mut seal = Seal::default();
    seal.add(MANIFEST, manifest.to_json().as_bytes());
    match files::open(&path.join(JOURNAL)) {
        Ok(journal) => seal.add_file(JOURNAL, journal).map_err(io)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(io(error)),
    }
    for (name, content) in files {
        seal.add(name, content);
    }
    replace(path, SEAL, seal.to_json().as_bytes())
}

/// What is wrong with the files of a folder, beside its manifest and what is known of its journal.
fn damage(path: &Path, journal: Vec<String>) -> Vec<String> {
    let (seal, damage) = Seal::read(path);
    let mut told = journal;
    told.extend(damage);
    let Some(seal) = seal else { return told };
    for name in seal.names() {
        // Line by line is more to the point.
        let is_journal = name == JOURNAL;
        if !is_journal || told.is_empty() {
            told.extend(seal.damage(path, name, is_journal));
        }
    }
    told
}

/// Removes a file of ours, if it is there.
fn remove(path: &Path, name: &str) -> Result<(), FolderError> {
    match fs::remove_file(path.join(name)) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(FolderError::Io {
            path: path.join(name),
            source: error,
        }),
        _ => Ok(()),
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
            let bytes = files::read_file(&path.join(MANIFEST), budget::MANIFEST).map_err(io)?;
            if let (Some(seal), _) = Seal::read(path)
                && seal.damage(path, MANIFEST, false).is_some()
            {
                let path = path.to_owned();
                return Err(FolderError::Damaged { path });
            }
            let json = String::from_utf8(bytes).map_err(|error| unreadable(error.to_string()))?;
            if (1..OLDEST).contains(&Manifest::format(&json).map_err(unreadable)?) {
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

pub(super) fn lock(path: &Path) -> Result<File, FolderError> {
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
