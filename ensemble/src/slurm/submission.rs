//! What was submitted for an ensemble, and who may submit more.
use std::fs::OpenOptions;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use stochc_files as files;
use stochc_files::atomic::{Replaces, make_own_folder, replace};
use stochc_files::budget::JOBS;
use stochc_files::checksum::{self, LineIntegrity, crc32};
use stochc_files::disk::Lock;

use super::Queue;
use crate::FolderError;
use crate::journal_line::line as journal_line;
use crate::shards::{Cut, PieceState, ShardError, same_build, status, thorough_status};
use crate::slurm_folder::{self, JOBS_FILE, LOCK, MERGE_SCRIPT, PIECES_SCRIPT, SLURM};

/// An ensemble in pieces, in a folder that all nodes see under the same name.
#[derive(Clone, Debug)]
pub struct SlurmEnsemble {
    /// The folder, as a whole path.
    pub path: PathBuf,
    /// Pieces that there are to be.
    pub pieces: u64,
    /// Runs of all of them.
    pub runs: u64,
    /// The name of its job arrays, which no other folder has.
    pub name: String,
}

/// What a folder is.
#[derive(Clone, Debug)]
pub enum Opened {
    /// An ensemble in pieces.
    Cut(SlurmEnsemble),
    /// One that has been put together, of so many runs.
    Merged(u64),
}

/// Jobs that were submitted together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Submission {
    /// The job array; `None`: nothing was missing.
    pub array: Option<u64>,
    /// Pieces of each of its tasks.
    pub per_task: u64,
    /// The job that puts the pieces together; `None`: it was not submitted.
    pub merge: Option<u64>,
}

/// What there is of the pieces.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FoundPieces {
    /// They are put together.
    Merged,
    /// All but these.
    AllBut(Vec<u64>),
}

/// The right to submit, until it is dropped: of those who ask on one machine, one has it.
///
/// Where nothing can be locked, everybody has it. Pieces that are made twice do no harm.
#[derive(Debug)]
pub struct Submitting {
    _lock: Option<files::File>,
}

#[derive(Serialize, Deserialize)]
struct SubmissionFile {
    submissions: Vec<Submission>,
}

impl SlurmEnsemble {
    /// The ensemble in a folder, given as a whole path.
    ///
    /// # Errors
    /// When it is not cut into pieces, or was made by another build, which could not make any here.
    pub fn open(path: &Path) -> Result<Opened, ShardError> {
        let (manifest, cut) = match Cut::of(path) {
            Err(ShardError::NotCut { done, total, .. }) if done == total => {
                return Ok(Opened::Merged(total));
            }
            cut => cut?,
        };
        same_build(path, &manifest)?;
        let identity = manifest.identity();
        let place = crc32(path.as_os_str().as_encoded_bytes());
        Ok(Opened::Cut(SlurmEnsemble {
            path: path.to_owned(),
            pieces: cut.shards,
            runs: manifest.total(),
            name: format!("stochc-{}-{place:08x}", &identity[..8]),
        }))
    }

    /// The name of the jobs that put its pieces together.
    pub fn merge_name(&self) -> String {
        format!("{}{}", self.name, super::queue::MERGE)
    }

    /// Looks what there is of its pieces: at the first line of each, or at all.
    ///
    /// # Errors
    /// When a file in the place of a piece is of something else, which no job would replace.
    pub fn look(&self, is_thorough: bool) -> Result<FoundPieces, ShardError> {
        let status = match is_thorough {
            true => thorough_status(&self.path),
            false => status(&self.path),
        };
        let status = match status {
            Err(ShardError::NotCut { done, total, .. }) if done == total => {
                return Ok(FoundPieces::Merged);
            }
            status => status?,
        };
        let foreign = (0..)
            .zip(&status.pieces)
            .filter_map(|(number, state)| match state {
                PieceState::Foreign { reason } => Some((number, reason.clone())),
                _ => None,
            });
        let pieces: Vec<_> = foreign.collect();
        match pieces.is_empty() {
            true => Ok(FoundPieces::AllBut(status.missing().collect())),
            false => Err(ShardError::Foreign {
                path: self.path.clone(),
                pieces,
            }),
        }
    }

    /// Reads what jobs are, by their name.
    pub fn queue(&self, printed: &str) -> Queue {
        Queue::read(printed, &self.name)
    }

    /// Asks for the right to submit; `None`: another process has it.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn submitting(&self) -> Result<Option<Submitting>, ShardError> {
        let mut options = OpenOptions::new();
        let options = options.create(true).truncate(false).write(true);
        let lock = match files::open_own(&self.file(LOCK), options) {
            // Nothing was submitted, or all is put together.
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            lock => Some(lock.map_err(self.io(LOCK))?),
        };
        match lock.as_ref().map(files::File::try_lock) {
            Some(Ok(Lock::Others)) => Ok(None),
            _ => Ok(Some(Submitting { _lock: lock })),
        }
    }

    /// Makes the folder for what is submitted.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn prepare(&self) -> Result<(), ShardError> {
        Ok(make_own_folder(&self.path.join(SLURM)).map_err(self.io(""))?)
    }

    /// Removes it, when the pieces are put together.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn clear(&self) -> Result<(), ShardError> {
        Ok(slurm_folder::clear(&self.path).map_err(self.io(""))?)
    }

    /// Writes the scripts, and tells where they are.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn write_scripts(&self, pieces: &str, merge: &str) -> Result<[PathBuf; 2], ShardError> {
        let write = |name: &str, text: &str| {
            let file = self.file(name);
            replace(&file, text.as_bytes(), Replaces::Ordinary).map_err(self.io(name))?;
            Ok::<_, FolderError>(file)
        };
        Ok([write(PIECES_SCRIPT, pieces)?, write(MERGE_SCRIPT, merge)?])
    }

    /// What was submitted until now.
    ///
    /// # Errors
    /// When the file cannot be used; jobs are found by their name also without it.
    pub fn submissions(&self) -> Result<Vec<Submission>, ShardError> {
        let bytes = match files::read_file(&self.file(JOBS_FILE), JOBS) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Vec::new()),
            bytes => bytes.map_err(self.io(JOBS_FILE))?,
        };
        let line = bytes.strip_suffix(b"\n").unwrap_or_default();
        match (
            checksum::check(line),
            serde_json::from_slice::<SubmissionFile>(line),
        ) {
            (LineIntegrity::Sound, Ok(file)) => Ok(file.submissions),
            _ => {
                let damaged =
                    "it is damaged; remove it, jobs that are queued are found by their name";
                let error = io::Error::new(io::ErrorKind::InvalidData, damaged);
                Err(self.io(JOBS_FILE)(error).into())
            }
        }
    }

    /// Keeps what was submitted: in the place of the last, if that has the same array.
    ///
    /// # Errors
    /// Those of the file system.
    pub fn submitted(&self, submission: Submission) -> Result<(), ShardError> {
        let mut submissions = self.submissions()?;
        let is_same = |last: &Submission| last.array.is_some() && last.array == submission.array;
        match submissions.last_mut().filter(|last| is_same(last)) {
            Some(last) => *last = submission,
            None => submissions.push(submission),
        }
        let text = journal_line(&SubmissionFile { submissions });
        let file = self.file(JOBS_FILE);
        Ok(replace(&file, text.as_bytes(), Replaces::Ordinary).map_err(self.io(JOBS_FILE))?)
    }

    /// The log of a task.
    pub fn task_log(&self, array: u64, task: u64) -> PathBuf {
        self.file(&format!("{array}_{task}.log"))
    }

    /// The log of a job that puts the pieces together.
    pub fn merge_log(&self, job: u64) -> PathBuf {
        self.file(&format!("merge_{job}.log"))
    }

    fn file(&self, name: &str) -> PathBuf {
        self.path.join(SLURM).join(name)
    }

    fn io(&self, name: &str) -> impl Fn(io::Error) -> FolderError {
        FolderError::of(self.file(name))
    }
}
