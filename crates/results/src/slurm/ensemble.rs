//! Ensemble that is split into shards, and its files for Slurm.
use std::fs::OpenOptions;
use std::io;
use std::path::{Path, PathBuf};

use stochc_files as files;
use stochc_files::atomic::{Replaces, make_own_folder, replace};
use stochc_files::checksum::crc32;
use stochc_files::disk::{self, FileLock};

use super::Queue;
use crate::FolderError;
use crate::folder::slurm_folder::{self, LOCK, MERGE_SCRIPT, SHARDS_SCRIPT, SLURM};
use crate::shards::{ShardError, ShardState, Split, same_build, status};

/// Ensemble that is split into shards. All nodes see its folder under the same path.
#[derive(Clone, Debug)]
pub struct SlurmEnsemble {
    /// Absolute path of the results folder.
    pub path: PathBuf,
    /// Number of shards.
    pub shards: u64,
    /// Name of the ensemble's job arrays. It is unique for each results folder.
    pub name: String,
}

/// State of a results folder that was opened to submit jobs.
#[derive(Clone, Debug)]
pub enum Opened {
    /// The ensemble is split into shards.
    Sharded(SlurmEnsemble),
    /// The shards are merged. Contains the number of runs.
    Merged(u64),
}

/// Shards that already exist.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FoundShards {
    /// All shards are merged. Contains the number of runs.
    Merged(u64),
    /// All shards exist except the listed ones.
    AllBut(Vec<u64>),
}

/// Lock of the process that submits jobs. Dropping it releases the lock.
///
/// On a file system without locks, every process gets the lock. Running a shard twice does no harm.
#[derive(Debug)]
pub struct SubmitLock {
    _lock: FileLock,
}

impl SlurmEnsemble {
    /// Opens the ensemble in a folder. `path` must be absolute.
    ///
    /// # Errors
    ///
    /// If the ensemble is not split, or if another build made it and this build cannot run its
    /// shards.
    pub fn open(path: &Path) -> Result<Opened, ShardError> {
        let (manifest, split) = match Split::require(path) {
            Err(ShardError::NotSplit { done, total, .. }) if done == total => {
                return Ok(Opened::Merged(total));
            }
            split => split?,
        };
        same_build(path, &manifest)?;
        let identity = manifest.identity();
        let place = crc32(path.as_os_str().as_encoded_bytes());
        Ok(Opened::Sharded(SlurmEnsemble {
            path: path.to_owned(),
            shards: split.shards,
            name: format!("stochc-{}-{place:08x}", &identity[..8]),
        }))
    }

    /// Returns the name of the ensemble's merge jobs.
    pub fn merge_name(&self) -> String {
        format!("{}{}", self.name, super::queue::MERGE)
    }

    /// Returns the existing shards, judged by the first line of each.
    ///
    /// # Errors
    ///
    /// If a shard's file is of another ensemble or split. No job would replace it.
    pub fn find_shards(&self) -> Result<FoundShards, ShardError> {
        let status = match status(&self.path) {
            Err(ShardError::NotSplit { done, total, .. }) if done == total => {
                return Ok(FoundShards::Merged(total));
            }
            status => status?,
        };
        let states = (0..).zip(&status.states);
        let foreign = states.filter_map(|(number, state)| match state {
            ShardState::Foreign { reason } => Some((number, reason.clone())),
            _ => None,
        });
        let shards: Vec<_> = foreign.collect();
        if shards.is_empty() {
            return Ok(FoundShards::AllBut(status.missing().collect()));
        }
        Err(ShardError::Foreign {
            path: self.path.clone(),
            shards,
        })
    }

    /// Reads the jobs of this ensemble from the output of `squeue`.
    pub fn queue(&self, output: &str) -> Queue {
        Queue::read(output, &self.name)
    }

    /// Creates the folder for Slurm and locks it. Returns `None` if another process has the lock.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn lock(&self) -> Result<Option<SubmitLock>, ShardError> {
        make_own_folder(&self.path.join(SLURM)).map_err(self.io(""))?;
        let mut options = OpenOptions::new();
        let options = options.create(true).truncate(false).write(true);
        let file = files::open_own(&self.file(LOCK), options).map_err(self.io(LOCK))?;
        let lock = file.try_lock().map_err(self.io(LOCK))?;
        Ok(lock.map(|lock| SubmitLock { _lock: lock }))
    }

    /// Removes the folder for Slurm of a merged ensemble.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn clear(&self) -> Result<(), ShardError> {
        Ok(slurm_folder::clear(&self.path).map_err(self.io(""))?)
    }

    /// Returns whether a job array was submitted, judged by the existence of its script.
    pub fn was_submitted(&self) -> bool {
        disk::look(&self.file(SHARDS_SCRIPT)).is_ok()
    }

    /// Returns whether a failed task or merge job has left a log.
    pub fn has_logs(&self) -> bool {
        let entries = disk::list(&self.path.join(SLURM)).unwrap_or_default();
        let is_log = |entry: &PathBuf| entry.extension().is_some_and(|it| it == "log");
        entries.iter().any(is_log)
    }

    /// Writes the scripts of an array and of a merge job, and returns their paths.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn write_scripts(&self, shards: &str, merge: &str) -> Result<[PathBuf; 2], ShardError> {
        let write = |name: &str, text: &str| {
            let file = self.file(name);
            replace(&file, text.as_bytes(), Replaces::Ordinary).map_err(self.io(name))?;
            Ok::<_, FolderError>(file)
        };
        Ok([write(SHARDS_SCRIPT, shards)?, write(MERGE_SCRIPT, merge)?])
    }

    /// Removes the script of an array that Slurm has rejected.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn remove_shards_script(&self) -> Result<(), ShardError> {
        Ok(disk::remove(&self.file(SHARDS_SCRIPT)).map_err(self.io(SHARDS_SCRIPT))?)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.path.join(SLURM).join(name)
    }

    fn io(&self, name: &str) -> impl Fn(io::Error) -> FolderError {
        FolderError::at(self.file(name))
    }
}
