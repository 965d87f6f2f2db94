//! The results folder of an ensemble: its files, and exclusive access to it.
//!
//! | file | content |
//! |---|---|
//! | `manifest.json` | everything that determines the ensemble |
//! | `journal.jsonl` | every finished run, in the order of finishing |
//! | `runs.parquet`, `phases.parquet`, `bonds.parquet`, `releases.parquet`, `unplanned.parquet` | the finished runs as tables, sorted by program and run; see `docs/reference/results.md` |
//! | `recordings/` | recorded runs for replay; see [`crate::recording`] |
//! | `checkpoints/` | the states of running runs; see [`crate::checkpoint`] |
//! | `checksums.json` | checksums of the other files, when all were last written |
//! | `.lock` | held by the process that writes |
//!
//! Results of another ensemble never replace files in the folder.
use std::fmt;
use std::fs::OpenOptions;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use stochc_files as files;
use stochc_files::atomic::{self, Draft, Replaces};
use stochc_files::budget;
use stochc_files::checksum::{Sum, Summed, sum_file};
use stochc_files::disk;
use stochc_files::disk::FileLock;

use crate::build::other_build;
use crate::checkpoint::{self, Checkpoints, Interval};
use crate::folder::FolderChecksums;
use crate::folder::FolderError;
use crate::folder::{
    CHECKPOINTS, CHECKSUMS_FILE, DAMAGED, JOURNAL, MANIFEST, RECORDINGS, SHARDS_FILE,
};
use crate::journal::JournalError;
use crate::journal::{self, Journal, JournalHeader};
use crate::manifest::Manifest;
use crate::parquet;
use crate::records::Finished;
use crate::records::LineLocation;
use crate::records::Records;

const LOCK: &str = ".lock";

/// Results folder with exclusive access, until it is dropped.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    manifest: Manifest,
    /// Builds that made the runs.
    builds: Vec<String>,
    /// Whether the stored manifest differs from the manifest of this folder and must be rewritten.
    is_changed: bool,
    state: FolderState,
    existing: Records,
    shortest: Option<Finished>,
    whole: u64,
    /// Manifest as stored. Set only if more runs are requested than stored and the journal has
    /// corrupted lines. These lines must be removed before runs are added.
    foul: Option<Manifest>,
    damage: Vec<String>,
    further: MakeFurther,
    checkpoints: Option<Arc<Checkpoints>>,
    /// Lock of the folder. The system releases it when the file is closed, also after a kill.
    _lock: FileLock,
}

/// Name and content of each additional file of a folder. An error if the folder's runs cannot be
/// read.
pub type FurtherFiles = Result<Vec<(String, Vec<u8>)>, JournalError>;

/// Function that generates additional files from the runs of a folder.
pub type Further = fn(&Manifest, &Records) -> FurtherFiles;

/// Generator of additional files. Unlike [`Further`], it may be a closure that captures values.
type MakeFiles = dyn Fn(&Manifest, &Records) -> FurtherFiles + Send + Sync;

struct MakeFurther(Box<MakeFiles>);

impl fmt::Debug for MakeFurther {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("MakeFurther")
    }
}

/// Valid content of a folder.
#[derive(Debug)]
pub struct Contents {
    /// Manifest of the ensemble.
    pub manifest: Manifest,
    /// Finished runs.
    pub finished: Records,
    /// Messages about corrupted files, a sentence each.
    pub damage: Vec<String>,
}

/// Rule for runs that a folder already contains: resume or extend them, or reject them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resume {
    /// Existing runs are rejected.
    No,
    /// Existing runs are resumed if this build made all of them.
    SameBuild,
    /// Existing runs are resumed, whatever builds made them.
    MixedBuilds,
}

impl From<bool> for Resume {
    fn from(resume: bool) -> Resume {
        if resume {
            Resume::SameBuild
        } else {
            Resume::No
        }
    }
}

/// State of an opened folder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FolderState {
    /// The folder was empty or absent.
    New,
    /// Some runs are missing.
    Resumed,
    /// All runs are finished.
    Finished,
}

impl Folder {
    /// Opens the folder at `path` for the ensemble of `manifest`, and creates it if necessary.
    ///
    /// # Errors
    ///
    /// Every error leaves the folder unchanged. Its message includes a remedy.
    pub fn open(
        path: &Path,
        manifest: &Manifest,
        resume: impl Into<Resume>,
    ) -> Result<Folder, FolderError> {
        reject_split(path)?;
        Folder::open_split(path, manifest, resume.into())
    }

    /// Opens a folder. Unlike [`Folder::open`], accepts a folder that is split into shards.
    pub(crate) fn open_split(
        path: &Path,
        manifest: &Manifest,
        resume: Resume,
    ) -> Result<Folder, FolderError> {
        let io = FolderError::at(path);
        // Check before anything is created: the folder may belong to another program.
        survey(path)?;
        atomic::make_folder(path).map_err(&io)?;
        let lock = lock(path)?;
        // Check again, now with exclusive access.
        let Some(stored) = survey(path)? else {
            atomic::clear_partial(path).map_err(&io)?;
            write_manifest(path, manifest)?;
            return Ok(Folder {
                path: path.to_owned(),
                manifest: manifest.clone(),
                builds: manifest.builds.clone(),
                state: FolderState::New,
                is_changed: false,
                existing: Records::default(),
                shortest: None,
                whole: 0,
                foul: None,
                damage: Vec::new(),
                further: MakeFurther(Box::new(|_, _| Ok(Vec::new()))),
                checkpoints: None,
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
                requested: manifest.runs,
            });
        }
        let journal = journal::read(&path.join(JOURNAL), &stored, &stored.identity())?;
        let is_extended = resume != Resume::No && stored.runs < manifest.runs;
        let foul = (is_extended && !journal.damage.is_empty()).then(|| stored.clone());
        let existing = journal.finished;
        let damage = damage(path, journal.damage);
        let (done, total) = (existing.len() as u64, manifest.total());
        if done < total && resume == Resume::No {
            return Err(FolderError::Unfinished {
                path: path.to_owned(),
                done,
                total,
            });
        }
        // Builds are mixed only if there are runs.
        let others = stored.builds != manifest.builds && done > 0;
        if done < total && others && resume != Resume::MixedBuilds {
            return Err(FolderError::OtherBuild {
                path: path.to_owned(),
                reason: other_build(&stored.builds).unwrap_or_default(),
            });
        }
        atomic::clear_partial(path).map_err(&io)?;
        let recordings = path.join(RECORDINGS);
        if recordings.is_dir() {
            atomic::clear_partial(&recordings).map_err(FolderError::at(&recordings))?;
        }
        let builds = if done == total {
            stored.builds.clone()
        } else {
            joined(&stored.builds, &manifest.builds)
        };
        Ok(Folder {
            path: path.to_owned(),
            is_changed: stored.runs < manifest.runs || stored.builds != builds,
            builds: stored.builds.clone(),
            // Properties that do not affect runs, such as paths of sources, keep their first
            // values.
            manifest: Manifest {
                runs: manifest.runs,
                builds,
                ..stored
            },
            state: if done == total {
                FolderState::Finished
            } else {
                FolderState::Resumed
            },
            existing,
            shortest: journal.shortest,
            whole: journal.whole,
            foul,
            damage,
            further: MakeFurther(Box::new(|_, _| Ok(Vec::new()))),
            checkpoints: None,
            _lock: lock,
        })
    }

    /// Reads the ensemble at `path`, finished or not, without a lock and without changing it.
    ///
    /// # Errors
    ///
    /// If there is no ensemble, or it cannot be read.
    pub fn read(path: &Path) -> Result<Contents, FolderError> {
        let absent = || FolderError::Absent(path.to_owned());
        let manifest = match survey(path) {
            Err(FolderError::NotResults(_) | FolderError::NotAFolder(_)) => None,
            surveyed => surveyed?,
        };
        let manifest = manifest.ok_or_else(absent)?;
        reject_split(path)?;
        let journal = journal::read(&path.join(JOURNAL), &manifest, &manifest.identity())?;
        Ok(Contents {
            manifest,
            finished: journal.finished,
            damage: damage(path, journal.damage),
        })
    }

    /// Adds a generator of additional files.
    pub fn with(
        mut self,
        further: impl Fn(&Manifest, &Records) -> FurtherFiles + Send + Sync + 'static,
    ) -> Folder {
        self.further = MakeFurther(Box::new(further));
        self
    }

    /// Enables checkpoints, and resumes from existing ones.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn with_checkpoints(mut self, every: Interval) -> Result<Folder, FolderError> {
        let wants = |program, run| self.wants(&self.existing, program, run);
        let opened = checkpoint::clear(&self.path, wants)
            .and_then(|()| Checkpoints::open(&self.path, &self.manifest, every, wants));
        let opened = opened.map_err(|source| self.in_checkpoints(source))?;
        self.checkpoints = Some(Arc::new(opened));
        Ok(self)
    }

    /// Removes the checkpoints of all runs in `finished`.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub(crate) fn clear_checkpoints(&self, finished: &Records) -> Result<(), FolderError> {
        if self.checkpoints.is_none() {
            return Ok(());
        }
        let wants = |program, run| self.wants(finished, program, run);
        checkpoint::clear(&self.path, wants).map_err(|source| self.in_checkpoints(source))
    }

    /// Returns whether a run must be made because it is not among the `finished` runs.
    fn wants(&self, finished: &Records, program: usize, run: u64) -> bool {
        let is_of_it = program < self.manifest.programs.len() && run < self.manifest.runs;
        is_of_it && !finished.contains(program, run)
    }

    fn in_checkpoints(&self, source: io::Error) -> FolderError {
        FolderError::at(self.path.join(CHECKPOINTS))(source)
    }

    /// Returns the checkpoints, if enabled.
    pub fn checkpoints(&self) -> Option<&Arc<Checkpoints>> {
        self.checkpoints.as_ref()
    }

    /// Returns the messages about corrupted files at opening, a sentence each.
    pub fn damage(&self) -> &[String] {
        &self.damage
    }

    /// Returns the manifest.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Returns the builds of `stochc` that made the runs.
    pub fn builds(&self) -> &[String] {
        &self.builds
    }

    /// Returns the state of the folder at its opening.
    pub fn state(&self) -> FolderState {
        self.state
    }

    /// Returns the runs that were finished at opening.
    pub fn existing(&self) -> &Records {
        &self.existing
    }

    /// Closes the folder. Returns its manifest and the runs that were finished at opening.
    pub(crate) fn close(self) -> (Manifest, Records) {
        (self.manifest, self.existing)
    }

    /// Returns the run with the fewest ticks. Considers only runs that existed at opening and did
    /// not fail.
    pub(crate) fn shortest(&self) -> Option<&Finished> {
        self.shortest.as_ref()
    }

    /// Removes corrupted lines from the journal if more runs are requested than stored. Otherwise,
    /// these lines might be mistaken for new runs. Must be called after all other checks.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub(crate) fn leave_foul_lines(&mut self) -> Result<(), FolderError> {
        if let Some(stored) = self.foul.take() {
            retain_valid_lines(&self.path, &stored)?;
            write_checksums(&self.path, &[])?;
            let journal = journal::read(&self.path.join(JOURNAL), &stored, &stored.identity())?;
            (self.existing, self.whole) = (journal.finished, journal.whole);
        }
        Ok(())
    }

    /// Opens the journal for new runs. Must be called only once, because it starts at the end that
    /// the journal had at opening.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub(crate) fn journal(&self) -> Result<Journal, FolderError> {
        self.write_manifest()?;
        let header = JournalHeader::new(&self.manifest.identity());
        let journal = Journal::open(&self.path.join(JOURNAL), &header, self.whole)?;
        atomic::sync_folder(&self.path).map_err(JournalError::Io)?;
        Ok(journal)
    }

    /// Returns the runs whose lines are at `locations` in the journal of the folder.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub(crate) fn records(&self, locations: Vec<LineLocation>) -> Result<Records, JournalError> {
        let file = files::open(&self.path.join(JOURNAL))?;
        let most = journal::most_line(&self.manifest);
        Ok(Records::at(locations, vec![file], most))
    }

    /// Writes the manifest if it has changed.
    pub(crate) fn write_manifest(&self) -> Result<(), FolderError> {
        if self.is_changed {
            write_manifest(&self.path, &self.manifest)
        } else {
            Ok(())
        }
    }

    /// Writes the tables, the additional files, and finally all checksums.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub(crate) fn write_tables(&self, finished: &Records) -> Result<(), FolderError> {
        // While the tables are being written, their old checksums are invalid.
        write_checksums(&self.path, &[])?;
        let mut sums = tables(&self.path, &self.manifest, finished, Replaces::Ordinary)?;
        for (name, content) in (self.further.0)(&self.manifest, finished)? {
            replace(&self.path, &name, &content)?;
            sums.push((name, Sum::from_bytes(&content)));
        }
        write_checksums(&self.path, &sums)
    }
}

/// Writes the Parquet tables of runs into a folder and replaces older tables. Creates the folder.
///
/// # Errors
///
/// Errors of the file system. Also if a file of the same name is not a table of `stochc`.
pub fn write_tables(
    path: &Path,
    manifest: &Manifest,
    finished: &Records,
) -> Result<(), FolderError> {
    atomic::make_folder(path).map_err(FolderError::at(path))?;
    let ours = Replaces::Ours(|file| atomic::ends_with(file, b"stochc.table"));
    tables(path, manifest, finished, ours).map(drop)
}

/// Writes the tables, and returns their checksums.
fn tables(
    path: &Path,
    manifest: &Manifest,
    finished: &Records,
    replaces: Replaces,
) -> Result<Vec<(String, Sum)>, FolderError> {
    let begin = |name: &str| Ok(Summed::new(Draft::new(&path.join(name), replaces)?));
    let tables = parquet::write(manifest, finished, begin, FolderError::at(path))?;
    let keep = |(name, table): (String, Summed<Draft>)| {
        let (draft, sum) = table.finish();
        draft.keep().map_err(FolderError::at(path.join(&name)))?;
        Ok((name, sum))
    };
    tables.into_iter().map(keep).collect()
}

/// Writes the manifest of a folder without tables.
pub(crate) fn write_manifest(path: &Path, manifest: &Manifest) -> Result<(), FolderError> {
    // The old checksums are invalid until new ones are written.
    remove(path, CHECKSUMS_FILE)?;
    replace(path, MANIFEST, manifest.to_json().as_bytes())?;
    write_checksums(path, &[])
}

/// Writes the checksums of the present manifest and journal, and of `files`.
pub(crate) fn write_checksums(path: &Path, files: &[(String, Sum)]) -> Result<(), FolderError> {
    let mut checksums = FolderChecksums::default();
    for name in [MANIFEST, JOURNAL] {
        let io = FolderError::at(path.join(name));
        match files::open(&path.join(name)) {
            Ok(file) => checksums.note(name, sum_file(file, u64::MAX).map_err(&io)?),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(io(error)),
        }
    }
    for (name, sum) in files {
        checksums.note(name, *sum);
    }
    replace(path, CHECKSUMS_FILE, checksums.to_json().as_bytes())
}

/// Returns an error if the folder has shards.
fn reject_split(path: &Path) -> Result<(), FolderError> {
    match disk::look(&path.join(SHARDS_FILE)) {
        Ok(_) => Err(FolderError::Split {
            path: path.to_owned(),
        }),
        Err(_) => Ok(()),
    }
}

/// Moves the journal of a folder to [`DAMAGED`] and replaces it by its valid lines.
///
/// # Errors
///
/// If the journal belongs to another ensemble, and errors of the file system.
pub(crate) fn retain_valid_lines(path: &Path, manifest: &Manifest) -> Result<(), FolderError> {
    let journal = path.join(JOURNAL);
    let of = || FolderError::at(&journal);
    // Something that is not a file has no valid lines.
    let text = if journal.is_file() {
        let text = journal::salvaged(&journal, manifest, &manifest.identity()).map_err(of())?;
        Some(text.ok_or(FolderError::Journal(JournalError::Foreign))?)
    } else {
        None
    };
    let corrupted = path.join(DAMAGED);
    atomic::move_aside(&journal, &corrupted).map_err(FolderError::at(&corrupted))?;
    match text {
        Some(text) => atomic::replace(&journal, &text, Replaces::Nothing).map_err(of()),
        None => Ok(()),
    }
}

/// Returns messages about all corrupted files of a folder except its manifest. `journal` contains
/// the messages about the journal, which come first.
fn damage(path: &Path, journal: Vec<String>) -> Vec<String> {
    let (checksums, damage) = FolderChecksums::read(path);
    let mut messages = journal;
    messages.extend(damage);
    let Some(checksums) = checksums else {
        return messages;
    };
    for name in checksums.names() {
        // Messages about single lines are more specific.
        let is_journal = name == JOURNAL;
        if !is_journal || messages.is_empty() {
            messages.extend(checksums.damage(path, name, is_journal));
        }
    }
    messages
}

/// Removes a file of the results folder if it exists.
fn remove(path: &Path, name: &str) -> Result<(), FolderError> {
    match disk::remove(&path.join(name)) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(FolderError::at(path.join(name))(error))
        }
        _ => Ok(()),
    }
}

/// Returns whether an entry of a folder is a lock file or left over from a killed process.
pub fn is_remnant(entry: &Path) -> bool {
    entry.file_name().is_some_and(|name| name == LOCK) || atomic::is_partial(entry)
}

/// Reads the manifest of a folder. Returns `None` if the folder does not exist or is empty.
///
/// # Errors
///
/// If the folder contains other files, or cannot be read.
pub fn survey(path: &Path) -> Result<Option<Manifest>, FolderError> {
    let unreadable = |reason| FolderError::Unreadable {
        path: path.to_owned(),
        reason,
    };
    let entries = match disk::list(path) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) if error.kind() == io::ErrorKind::NotADirectory => {
            return Err(FolderError::NotAFolder(path.to_owned()));
        }
        Err(error) => return Err(FolderError::at(path)(error)),
    };
    let mut foreign = false;
    for entry in entries {
        let name = entry.file_name().unwrap_or_default();
        if name == MANIFEST {
            let file = path.join(MANIFEST);
            let bytes = files::read_file(&file, budget::MANIFEST).map_err(FolderError::at(file))?;
            as_written(path)?;
            let json = std::str::from_utf8(&bytes).map_err(|error| unreadable(error.into()))?;
            return Manifest::from_json(json).map(Some).map_err(unreadable);
        }
        foreign |= !is_remnant(&entry);
    }
    if !foreign {
        Ok(None)
    } else {
        Err(without_manifest(path, FolderError::NotResults))
    }
}

/// Checks a manifest in a results folder against its checksum.
///
/// # Errors
///
/// If it is corrupted.
pub fn check_manifest(file: &Path) -> Result<(), FolderError> {
    match (file.parent(), file.file_name()) {
        (Some(folder), Some(name)) if name == MANIFEST => as_written(folder),
        _ => Ok(()),
    }
}

/// Checks the manifest of a folder against its checksum. Accepts a manifest without a checksum.
fn as_written(folder: &Path) -> Result<(), FolderError> {
    match FolderChecksums::read(folder) {
        (Some(checksums), _) if checksums.damage(folder, MANIFEST, false).is_some() => {
            let path = if folder.as_os_str().is_empty() {
                PathBuf::from(".")
            } else {
                folder.to_owned()
            };
            Err(FolderError::Corrupted { path })
        }
        _ => Ok(()),
    }
}

/// Returns the error for a folder without a manifest. Calls `otherwise` for the error if the folder
/// has no journal either.
pub(crate) fn without_manifest(
    path: &Path,
    otherwise: impl FnOnce(PathBuf) -> FolderError,
) -> FolderError {
    if path.join(JOURNAL).is_file() {
        FolderError::NoManifest(path.to_owned())
    } else {
        otherwise(path.to_owned())
    }
}

pub(crate) fn lock(path: &Path) -> Result<FileLock, FolderError> {
    let lock = path.join(LOCK);
    let io = FolderError::at(&lock);
    let mut options = OpenOptions::new();
    let options = options.create(true).truncate(false).write(true);
    let file = files::open_own(&lock, options).map_err(&io)?;
    let lock = file.try_lock().map_err(&io)?;
    lock.ok_or_else(|| FolderError::Locked(path.to_owned()))
}

/// Writes a file of a results folder and replaces an earlier one.
pub(crate) fn replace(path: &Path, name: &str, content: &[u8]) -> Result<(), FolderError> {
    let path = path.join(name);
    atomic::replace(&path, content, Replaces::Ordinary).map_err(FolderError::at(path))
}

/// Returns the builds in `stored`, followed by the new ones in `here`.
fn joined(stored: &[String], here: &[String]) -> Vec<String> {
    let mut all = stored.to_vec();
    for build in here {
        if !all.contains(build) {
            all.push(build.clone());
        }
    }
    all
}
