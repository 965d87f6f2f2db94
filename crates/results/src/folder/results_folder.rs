//! The folder of an ensemble: who may write to it, and what it holds already.
//!
//! | file | what |
//! |---|---|
//! | `manifest.json` | what the ensemble depends on |
//! | `journal.jsonl` | every finished run, in the order of finishing |
//! | `runs.parquet`, `phases.parquet`, `bonds.parquet`, `releases.parquet`, `unplanned.parquet` | the same as tables, in the order of program and run; see `docs/reference/results.md` |
//! | `recordings/` | runs to watch; see [`crate::recording`] |
//! | `checkpoints/` | the states of runs under way; see [`crate::checkpoint`] |
//! | `checksums.json` | of the others, when they were last written as a whole; see [`crate::folder`] |
//! | `.lock` | held by the process that writes |
//!
//! Nothing in it is ever replaced by the results of another ensemble.
use std::fmt;
use std::fs::OpenOptions;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use stochc_files as files;
use stochc_files::atomic::{self, Draft, Replaces};
use stochc_files::budget;
use stochc_files::checksum::{Sum, Summed, of_file};
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

/// A results folder that belongs to this process until it is dropped.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    manifest: Manifest,
    /// That made the runs it holds.
    builds: Vec<String>,
    /// Whether its manifest is not yet the one that it has been opened for.
    is_changed: bool,
    state: FolderState,
    kept: Records,
    shortest: Option<Finished>,
    whole: u64,
    /// What its journal was for, if it has damaged lines that have to go before it gets more runs than that.
    foul: Option<Manifest>,
    damage: Vec<String>,
    further: MakeFurther,
    checkpoints: Option<Arc<Checkpoints>>,
    /// Unlocked by the system when it is closed, also by a kill.
    _lock: FileLock,
}

/// Further files of a folder, by their names; or why its runs could not be read.
pub type FurtherFiles = Result<Vec<(String, Vec<u8>)>, JournalError>;

/// What makes further files of a folder from its runs.
pub type Further = fn(&Manifest, &Records) -> FurtherFiles;

/// The same, with whatever it has to know.
type MakeFiles = dyn Fn(&Manifest, &Records) -> FurtherFiles + Send + Sync;

struct MakeFurther(Box<MakeFiles>);

impl fmt::Debug for MakeFurther {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("MakeFurther")
    }
}

/// What a folder holds, as far as it is sound.
#[derive(Debug)]
pub struct Contents {
    /// What its ensemble depends on.
    pub manifest: Manifest,
    /// Its runs.
    pub finished: Records,
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
        if resume {
            Resume::SameBuild
        } else {
            Resume::No
        }
    }
}

/// What an opened folder is good for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FolderState {
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
    /// Every error leaves the folder as it was; its message says the way out.
    pub fn open(
        path: &Path,
        manifest: &Manifest,
        resume: impl Into<Resume>,
    ) -> Result<Folder, FolderError> {
        not_cut(path)?;
        Folder::open_cut(path, manifest, resume.into())
    }

    /// The same, also if it is cut into pieces.
    pub(crate) fn open_cut(
        path: &Path,
        manifest: &Manifest,
        resume: Resume,
    ) -> Result<Folder, FolderError> {
        let io = FolderError::at(path);
        // Before anything is created: the folder may be somebody else's.
        survey(path)?;
        atomic::make_folder(path).map_err(&io)?;
        let lock = lock(path)?;
        // Again, now that nobody else can change the answer.
        let Some(stored) = survey(path)? else {
            atomic::clear_partial(path).map_err(&io)?;
            write_manifest(path, manifest)?;
            return Ok(Folder {
                path: path.to_owned(),
                manifest: manifest.clone(),
                builds: manifest.builds.clone(),
                state: FolderState::New,
                is_changed: false,
                kept: Records::default(),
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
                asked: manifest.runs,
            });
        }
        let journal = journal::read(&path.join(JOURNAL), &stored, &stored.identity())?;
        let is_extended = resume != Resume::No && stored.runs < manifest.runs;
        let foul = (is_extended && !journal.damage.is_empty()).then(|| stored.clone());
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
            // What tells no runs apart, such as where the texts were read, stays as it was told first.
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
            kept,
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
    /// When there is no ensemble, or it cannot be read.
    pub fn read(path: &Path) -> Result<Contents, FolderError> {
        let absent = || FolderError::Absent(path.to_owned());
        let manifest = match survey(path) {
            Err(FolderError::NotResults(_) | FolderError::NotAFolder(_)) => None,
            surveyed => surveyed?,
        };
        let manifest = manifest.ok_or_else(absent)?;
        not_cut(path)?;
        let journal = journal::read(&path.join(JOURNAL), &manifest, &manifest.identity())?;
        Ok(Contents {
            manifest,
            finished: journal.finished,
            damage: damage(path, journal.damage),
        })
    }

    /// Has further files written with the tables.
    pub fn with(
        mut self,
        further: impl Fn(&Manifest, &Records) -> FurtherFiles + Send + Sync + 'static,
    ) -> Folder {
        self.further = MakeFurther(Box::new(further));
        self
    }

    /// Has the states of runs under way kept, and has those go on of which there is one.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn with_checkpoints(mut self, every: Interval) -> Result<Folder, FolderError> {
        let wants = |program, run| self.wants(&self.kept, program, run);
        let opened = checkpoint::clear(&self.path, wants)
            .and_then(|()| Checkpoints::open(&self.path, &self.manifest, every, wants));
        let opened = opened.map_err(|source| self.in_checkpoints(source))?;
        self.checkpoints = Some(Arc::new(opened));
        Ok(self)
    }

    /// Removes the states of runs that are `finished`.
    ///
    /// # Errors
    /// Those of the file system.
    pub(crate) fn clear_checkpoints(&self, finished: &Records) -> Result<(), FolderError> {
        if self.checkpoints.is_none() {
            return Ok(());
        }
        let wants = |program, run| self.wants(finished, program, run);
        checkpoint::clear(&self.path, wants).map_err(|source| self.in_checkpoints(source))
    }

    /// Whether a run is to be made that is not `finished`.
    fn wants(&self, finished: &Records, program: usize, run: u64) -> bool {
        let is_of_it = program < self.manifest.programs.len() && run < self.manifest.runs;
        is_of_it && !finished.contains(program, run)
    }

    fn in_checkpoints(&self, source: io::Error) -> FolderError {
        FolderError::at(self.path.join(CHECKPOINTS))(source)
    }

    /// The states of its runs, if they are kept.
    pub fn checkpoints(&self) -> Option<&Arc<Checkpoints>> {
        self.checkpoints.as_ref()
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
    pub fn state(&self) -> FolderState {
        self.state
    }

    /// The runs that were done when it was opened.
    pub fn kept(&self) -> &Records {
        &self.kept
    }

    /// Lets go of the folder, but for the runs that it was opened with.
    pub(crate) fn close(self) -> (Manifest, Records) {
        (self.manifest, self.kept)
    }

    /// The shortest of them that did not fail.
    pub(crate) fn shortest(&self) -> Option<&Finished> {
        self.shortest.as_ref()
    }

    /// Leaves the damaged lines of its journal behind, where there will be more runs than it was for: of one of those some line could say what
    /// can be. To be called when nothing is refused any more.
    ///
    /// # Errors
    /// Those of the file system.
    pub(crate) fn leave_foul_lines(&mut self) -> Result<(), FolderError> {
        if let Some(stored) = self.foul.take() {
            keep_sound_lines(&self.path, &stored)?;
            write_checksums(&self.path, &[])?;
            let journal = journal::read(&self.path.join(JOURNAL), &stored, &stored.identity())?;
            (self.kept, self.whole) = (journal.finished, journal.whole);
        }
        Ok(())
    }

    /// Opens the journal for the runs that are still to be done; once, since it begins where the
    /// journal ended when the folder was opened.
    ///
    /// # Errors
    /// Those of the file system.
    pub(crate) fn journal(&self) -> Result<Journal, FolderError> {
        self.write_manifest()?;
        let header = JournalHeader::new(&self.manifest.identity());
        let journal = Journal::open(&self.path.join(JOURNAL), &header, self.whole)?;
        atomic::sync_folder(&self.path).map_err(JournalError::Io)?;
        Ok(journal)
    }

    /// The runs at these places of its journal.
    ///
    /// # Errors
    /// Those of the file system.
    pub(crate) fn records(&self, places: Vec<LineLocation>) -> Result<Records, JournalError> {
        let file = files::open(&self.path.join(JOURNAL))?;
        let most = journal::most_line(&self.manifest);
        Ok(Records::at(places, vec![file], most))
    }

    /// Writes the manifest if it is not yet the one that the folder has been opened for.
    pub(crate) fn write_manifest(&self) -> Result<(), FolderError> {
        if self.is_changed {
            write_manifest(&self.path, &self.manifest)
        } else {
            Ok(())
        }
    }

    /// Writes the tables, the further files, and at last the checksums of all.
    ///
    /// # Errors
    /// Those of the file system.
    pub(crate) fn write_tables(&self, finished: &Records) -> Result<(), FolderError> {
        // Tables that are being written are not those that are known.
        write_checksums(&self.path, &[])?;
        let mut sums = tables(&self.path, &self.manifest, finished, Replaces::Ordinary)?;
        for (name, content) in (self.further.0)(&self.manifest, finished)? {
            replace(&self.path, &name, &content)?;
            sums.push((name, Sum::from_bytes(&content)));
        }
        write_checksums(&self.path, &sums)
    }
}

/// Writes the Parquet tables of runs into a folder, in the place of older tables, and makes the folder.
///
/// # Errors
/// If the file system refuses, or a file that is not a table of ours is in the way.
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

/// Writes the manifest of a folder, which has no tables of it yet.
pub(crate) fn write_manifest(path: &Path, manifest: &Manifest) -> Result<(), FolderError> {
    // What is there is not what is known, until it is sealed again.
    remove(path, CHECKSUMS_FILE)?;
    replace(path, MANIFEST, manifest.to_json().as_bytes())?;
    write_checksums(path, &[])
}

/// Writes the checksums of the manifest and of the journal as they are, and of these files.
pub(crate) fn write_checksums(path: &Path, files: &[(String, Sum)]) -> Result<(), FolderError> {
    let mut checksums = FolderChecksums::default();
    for name in [MANIFEST, JOURNAL] {
        let io = FolderError::at(path.join(name));
        match files::open(&path.join(name)) {
            Ok(file) => checksums.note(name, of_file(file, u64::MAX).map_err(&io)?),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {}
            Err(error) => return Err(io(error)),
        }
    }
    for (name, sum) in files {
        checksums.note(name, *sum);
    }
    replace(path, CHECKSUMS_FILE, checksums.to_json().as_bytes())
}

/// Refuses a folder whose runs are in pieces.
fn not_cut(path: &Path) -> Result<(), FolderError> {
    match disk::look(&path.join(SHARDS_FILE)) {
        Ok(_) => Err(FolderError::Cut {
            path: path.to_owned(),
        }),
        Err(_) => Ok(()),
    }
}

/// Moves the journal of a folder aside, into [`DAMAGED`], and leaves its sound lines in its place.
///
/// # Errors
/// If it is of another ensemble, or the file system refuses.
pub(crate) fn keep_sound_lines(path: &Path, manifest: &Manifest) -> Result<(), FolderError> {
    let journal = path.join(JOURNAL);
    let of = || FolderError::at(&journal);
    // Nothing is sound of what is no file.
    let text = if journal.is_file() {
        let text = journal::salvaged(&journal, manifest, &manifest.identity()).map_err(of())?;
        Some(text.ok_or(FolderError::Journal(JournalError::Foreign))?)
    } else {
        None
    };
    let damaged = path.join(DAMAGED);
    atomic::move_aside(&journal, &damaged).map_err(FolderError::at(&damaged))?;
    match text {
        Some(text) => atomic::replace(&journal, &text, Replaces::Nothing).map_err(of()),
        None => Ok(()),
    }
}

/// What is wrong with the files of a folder, beside its manifest and what is known of its journal.
fn damage(path: &Path, journal: Vec<String>) -> Vec<String> {
    let (checksums, damage) = FolderChecksums::read(path);
    let mut told = journal;
    told.extend(damage);
    let Some(checksums) = checksums else {
        return told;
    };
    for name in checksums.names() {
        // Line by line is more to the point.
        let is_journal = name == JOURNAL;
        if !is_journal || told.is_empty() {
            told.extend(checksums.damage(path, name, is_journal));
        }
    }
    told
}

/// Removes a file of ours, if it is there.
fn remove(path: &Path, name: &str) -> Result<(), FolderError> {
    match disk::remove(&path.join(name)) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => {
            Err(FolderError::at(path.join(name))(error))
        }
        _ => Ok(()),
    }
}

/// Whether an entry of a folder is nobody's: a lock, or the draft of a process that was killed.
pub fn is_remnant(entry: &Path) -> bool {
    entry.file_name().is_some_and(|name| name == LOCK) || atomic::is_partial(entry)
}

/// Reads the manifest of a folder; `None`: there is no folder, or nothing of anybody's in it.
///
/// # Errors
/// If it holds something else, or what cannot be read.
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
            let json = String::from_utf8(bytes).map_err(|error| unreadable(error.to_string()))?;
            return Manifest::from_json(&json).map(Some).map_err(unreadable);
        }
        foreign |= !is_remnant(&entry);
    }
    if !foreign {
        Ok(None)
    } else {
        Err(without_manifest(path, FolderError::NotResults))
    }
}

/// Holds a manifest against what was written, if it lies in a folder of results.
///
/// # Errors
/// If it is not as it was written.
pub fn check_manifest(file: &Path) -> Result<(), FolderError> {
    match (file.parent(), file.file_name()) {
        (Some(folder), Some(name)) if name == MANIFEST => as_written(folder),
        _ => Ok(()),
    }
}

/// Holds the manifest of a folder against its checksum, if that is known.
fn as_written(folder: &Path) -> Result<(), FolderError> {
    match FolderChecksums::read(folder) {
        (Some(checksums), _) if checksums.damage(folder, MANIFEST, false).is_some() => {
            let path = if folder.as_os_str().is_empty() {
                PathBuf::from(".")
            } else {
                folder.to_owned()
            };
            Err(FolderError::Damaged { path })
        }
        _ => Ok(()),
    }
}

/// What is wrong with a folder that has no manifest; `otherwise`: where it has no runs either.
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

/// Writes a file of a folder of results, in the place of an earlier one.
pub(crate) fn replace(path: &Path, name: &str, content: &[u8]) -> Result<(), FolderError> {
    let path = path.join(name);
    atomic::replace(&path, content, Replaces::Ordinary).map_err(FolderError::at(path))
}

/// The builds of a folder, after one more has made runs.
fn joined(stored: &[String], here: &[String]) -> Vec<String> {
    let mut all = stored.to_vec();
    for build in here {
        if !all.contains(build) {
            all.push(build.clone());
        }
    }
    all
}
