//! Execution of one shard.
use std::io::{self, Write as _};
use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use stochc_files as files;
use stochc_files::atomic::{Draft, Replaces, make_own_folder, move_aside, new_own, sync_folder};
use stochc_files::disk;
use stochc_ir::record::RunRecord;

use super::ShardError;
use super::split::{Split, is_joined, same_build, shard_file};
use crate::execution::{PendingRuns, job, number as job_number};
use crate::execution::{RunTracker, check_again, journaled};
use crate::folder::{DAMAGED, SHARDS};
use crate::journal::line as journal_line;
use crate::journal::{self, Journal, JournalHeader, Shortest};
use crate::records::LineLocation;
use crate::records::RecordValidator;
use crate::records::Records;
use crate::{
    CHECKPOINTS, Checkpoints, EnsembleError, Finished, FolderError, Interval, JournalError,
    Manifest, Progress, RunCancelled, RunWatch, this_build,
};

/// Shard that this process runs.
#[derive(Debug)]
pub struct Shard {
    path: PathBuf,
    manifest: Manifest,
    number: u64,
    header: JournalHeader,
    jobs: Range<u64>,
    is_made: bool,
    /// Finished runs of the shard at opening, made by processes that did not complete it.
    existing: Records,
    shortest: Option<Finished>,
    checkpoints: Option<Checkpoints>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum ShardFile {
    Nothing,
    Whole,
    /// The file is corrupted. The reason continues a sentence that begins with the name of the
    /// shard.
    Corrupted(String),
    /// The file is not of this shard. The description continues a sentence that begins with the
    /// name of the shard.
    Foreign(String),
}

impl Shard {
    /// Opens shard `number` of the ensemble at `path`, and collects its existing runs.
    ///
    /// # Errors
    ///
    /// Every error leaves the folder unchanged.
    pub fn open(path: &Path, number: u64) -> Result<Shard, ShardError> {
        let (manifest, cut) = Split::require(path)?;
        same_build(path, &manifest)?;
        if number >= cut.shards {
            let last = cut.shards - 1;
            return Err(ShardError::NoSuchShard { number, last });
        }
        let (header, jobs) = (
            cut.header(&this_build(), number),
            cut.jobs(manifest.total(), number),
        );
        let file = shard_file(path, number);
        let look = || read(&file, &header, &manifest, &jobs, |_| Ok(()));
        let mut found = look()?;
        // A killed `merge` may have removed some shards after the journal was complete.
        let is_joined = found != ShardFile::Whole && is_joined(path, &manifest)?;
        if matches!(found, ShardFile::Corrupted(_)) && !is_joined {
            // Another process may have completed the shard in the meantime.
            found = look()?;
        }
        let is_made = found == ShardFile::Whole || is_joined;
        let is_corrupted = matches!(found, ShardFile::Corrupted(_)) && !is_joined;
        if let ShardFile::Foreign(what) = found {
            return Err(ShardError::Foreign {
                path: path.to_owned(),
                shards: vec![(number, what)],
            });
        }
        let mut shard = Shard {
            path: path.to_owned(),
            is_made,
            existing: Records::default(),
            shortest: None,
            checkpoints: None,
            manifest,
            number,
            header,
            jobs,
        };
        if !shard.is_made {
            shard.collect()?;
        }
        if is_corrupted {
            set_aside(&file, &path.join(DAMAGED)).map_err(|source| in_folder(path, source))?;
        }
        Ok(shard)
    }

    /// Enables checkpoints, and resumes from existing ones.
    ///
    /// # Errors
    ///
    /// Errors of the file system.
    pub fn with_checkpoints(mut self, every: Interval) -> Result<Shard, ShardError> {
        let programs = self.manifest.programs.len() as u64;
        let wants = |program: usize, run: u64| {
            let number = job_number(program, run, programs);
            let is_of_it = number.is_some_and(|number| self.jobs.contains(&number));
            is_of_it && !self.is_made && !self.existing.contains(program, run)
        };
        let opened = Checkpoints::open(&self.path, &self.manifest, every, wants);
        let io = FolderError::at(self.path.join(CHECKPOINTS));
        self.checkpoints = Some(opened.map_err(io)?);
        Ok(self)
    }

    /// Returns the checkpoints, if enabled.
    pub fn checkpoints(&self) -> Option<&Checkpoints> {
        self.checkpoints.as_ref()
    }

    /// Returns the manifest of the whole ensemble.
    pub fn manifest(&self) -> &Manifest {
        &self.manifest
    }

    /// Returns whether all runs of the shard are finished.
    pub fn is_made(&self) -> bool {
        self.is_made
    }

    /// Returns the number of all runs of the shard, and the number of its finished runs.
    pub fn runs(&self) -> (u64, u64) {
        let all = self.jobs.end - self.jobs.start;
        let done = if self.is_made {
            all
        } else {
            self.existing.len() as u64
        };
        (all, done)
    }

    /// Returns the initial progress of the shard for a number of threads.
    pub fn progress(&self, threads: NonZeroUsize) -> Progress {
        Progress::from_jobs(&self.manifest, &self.jobs, threads)
    }

    /// Repeats the shortest existing run, as [`check_stored`](crate::check_stored) does.
    ///
    /// # Errors
    ///
    /// [`EnsembleError::Differs`].
    pub fn check_stored(
        &self,
        simulate: impl FnOnce(usize, u64) -> Result<RunRecord, RunCancelled>,
    ) -> Result<(), EnsembleError> {
        check_again(&self.manifest, self.shortest.as_ref(), simulate)
    }

    /// Makes the missing runs of the shard, as [`run`](crate::run) does. Returns whether the shard
    /// is complete.
    ///
    /// # Errors
    ///
    /// Errors of the file system. Finished runs remain.
    pub fn make(
        &self,
        progress: &Progress,
        stop: &AtomicBool,
        simulate: impl Fn(usize, u64, &RunWatch) -> Result<RunRecord, RunCancelled> + Sync,
    ) -> Result<bool, ShardError> {
        if self.is_made {
            return Ok(true);
        }
        progress.count_existing(&self.existing)?;
        let pending = PendingRuns::all(&self.manifest, self.jobs.clone(), Some(&self.existing));
        if pending.left == 0 {
            return self.finish(&self.existing).map(|()| true);
        }
        let folder = self.path.join(SHARDS);
        let io = |source| in_folder(&self.path, source);
        // A copy of the results folder may lack this folder.
        make_own_folder(&folder).map_err(io)?;
        let part = new_own(&folder, &format!("{}.part-", self.number)).map_err(io)?;
        sync_folder(&folder).map_err(io)?;
        let of_part = |error| match error {
            JournalError::Io(source) => FolderError::at(&part)(source),
            error => FolderError::Journal(error),
        };
        let journal = Journal::open(&part, &self.header, 0).map_err(of_part)?;
        let file = self.existing.files();
        let tracker = RunTracker {
            progress,
            checkpoints: self.checkpoints(),
        };
        let locations =
            journaled(pending, journal, file, tracker, stop, simulate).map_err(of_part)?;
        let opened = files::open(&part).map_err(io)?;
        let most = journal::most_line(&self.manifest);
        let all = self.existing.and(&locations, opened, most).map_err(io)?;
        if (all.len() as u64) < self.jobs.end - self.jobs.start {
            return Ok(false);
        }
        self.finish(&all)?;
        // `merge` removes leftovers of killed processes.
        disk::remove(&part).map_err(io)?;
        Ok(true)
    }

    /// Writes the file of the complete shard. Concurrent processes write the same bytes.
    fn finish(&self, all: &Records) -> Result<(), ShardError> {
        let io = |source| in_folder(&self.path, source);
        let file = shard_file(&self.path, self.number);
        let mut draft = Draft::new(&file, Replaces::Same).map_err(io)?;
        let header = journal_line(&self.header);
        draft.write_all(header.as_bytes()).map_err(io)?;
        let programs = self.manifest.programs.len() as u64;
        let jobs = self.jobs.clone().map(|number| job(number, programs));
        let keys = jobs.map(|job| (job.program, job.run));
        all.try_each_of(keys, |done| {
            draft.write_all(journal_line(done).as_bytes())?;
            Ok::<_, JournalError>(())
        })?;
        Ok(draft.keep().map_err(io)?)
    }

    /// Collects the runs of the shard that other processes have finished.
    fn collect(&mut self) -> Result<(), ShardError> {
        let (mut locations, mut parts) = (Vec::new(), Vec::new());
        let mut shortest = Shortest::default();
        let most = journal::most_line(&self.manifest);
        let programs = self.manifest.programs.len() as u64;
        let validator = RecordValidator::new(&self.manifest);
        for part in parts_of(&self.path, self.number).map_err(|it| in_folder(&self.path, it))? {
            let number = parts.len() as u32;
            let read = journal::read_lines(&part, &self.header, most, |line| {
                let Ok(done) = journal::run(line.text, &validator) else {
                    return;
                };
                let job = job_number(done.program, done.record.run, programs);
                if job.is_some_and(|job| self.jobs.contains(&job)) {
                    locations.push(done.at(number, line.at));
                    shortest.offer(done);
                }
            });
            let read = match read {
                Ok(_) => files::open(&part),
                Err(_) => Err(io::ErrorKind::NotFound.into()),
            };
            match read {
                Ok(opened) => parts.push(opened),
                // The file is of another ensemble, or was removed because its process has completed
                // the shard.
                Err(_) => locations.retain(|location: &LineLocation| location.file != number),
            }
        }
        self.shortest = shortest.0;
        self.existing = Records::at(locations, parts, most);
        Ok(())
    }
}

/// Reads and validates the file of a shard. Calls `each` with the line of each run.
///
/// # Errors
///
/// Errors of `each`.
pub(super) fn read(
    file: &Path,
    header: &JournalHeader,
    manifest: &Manifest,
    jobs: &Range<u64>,
    mut each: impl FnMut(&[u8]) -> io::Result<()>,
) -> Result<ShardFile, ShardError> {
    match identify(file, header)? {
        ShardFile::Whole => {}
        other => return Ok(other),
    }
    let programs = manifest.programs.len() as u64;
    let mut next = jobs.start;
    let (mut wrong, mut broken) = (None, None);
    let most = journal::most_line(manifest);
    let validator = RecordValidator::new(manifest);
    let lines = journal::read_lines(file, header, most, |line| {
        if wrong.is_some() || broken.is_some() {
            return;
        }
        let number = line.number;
        match journal::run(line.text, &validator) {
            Err(reason) => wrong = Some(format!("is damaged: its line {number} {reason}")),
            Ok(done) => {
                let expected = job(next, programs);
                let is_next = (done.program, done.record.run) == (expected.program, expected.run);
                if next < jobs.end && is_next {
                    broken = each(line.text).err()
                } else {
                    wrong = Some(format!("is damaged: its line {number} is another run"))
                }
                next += 1;
            }
        }
    });
    if let Some(error) = broken {
        return Err(JournalError::Io(error).into());
    }
    Ok(match (lines, wrong) {
        // Another process has moved the file in the meantime.
        (Err(JournalError::Io(error)), _) if error.kind() == io::ErrorKind::NotFound => {
            ShardFile::Nothing
        }
        (Err(JournalError::Io(error)), _) => unreadable(error)?,
        (Err(error), _) => ShardFile::Corrupted(format!("cannot be read: {error}")),
        (_, Some(wrong)) => ShardFile::Corrupted(wrong),
        _ if next < jobs.end => ShardFile::Corrupted(format!(
            "is damaged: it has {} of {} runs",
            next - jobs.start,
            jobs.end - jobs.start
        )),
        _ => ShardFile::Whole,
    })
}

/// Returns the state of a shard's file, judged by its first line.
///
/// # Errors
///
/// Errors of the file system, which may be temporary.
pub(super) fn identify(file: &Path, header: &JournalHeader) -> Result<ShardFile, JournalError> {
    let found = match journal::read_header(file) {
        Ok(Some(found)) => found,
        Ok(None) => {
            let what = "is damaged: its first line was changed";
            return Ok(ShardFile::Corrupted(what.to_owned()));
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(ShardFile::Nothing),
        Err(error) => return unreadable(error),
    };
    if found.ensemble != header.ensemble {
        return Ok(ShardFile::Foreign("belongs to another manifest".to_owned()));
    }
    Ok(match (&found.shard, &header.shard) {
        (Some(there), Some(here)) if there == here => ShardFile::Whole,
        (Some(there), Some(here))
            if (there.number, there.shards, there.runs)
                == (here.number, here.shards, here.runs) =>
        {
            ShardFile::Foreign(format!(
                "was made by another build of `stochc` ({}, and that of the manifest is {})",
                there.build, here.build
            ))
        }
        (Some(there), _) => ShardFile::Foreign(format!(
            "is in fact shard {} of {}, for {} runs of each program",
            there.number, there.shards, there.runs
        )),
        (None, _) => ShardFile::Foreign("is in fact the journal of a whole ensemble".to_owned()),
    })
}

/// Moves a corrupted shard aside, unless another process has already moved it.
fn set_aside(file: &Path, corrupted: &Path) -> io::Result<()> {
    match move_aside(file, corrupted) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        moved => moved.map(drop),
    }
}

/// Returns the state of a shard whose file cannot be read: corrupted, unless the error comes from
/// the operating system.
///
/// # Errors
///
/// Errors of the operating system.
fn unreadable(error: io::Error) -> Result<ShardFile, JournalError> {
    match error.raw_os_error() {
        Some(_) => Err(error.into()),
        None => Ok(ShardFile::Corrupted(format!("cannot be read: {error}"))),
    }
}

/// Returns the files that contain the runs of an incomplete shard, sorted by name.
pub(super) fn parts_of(path: &Path, number: u64) -> io::Result<Vec<PathBuf>> {
    let prefix = format!("{number}.part-");
    let mut parts = Vec::new();
    let entries = match disk::list(&path.join(SHARDS)) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Vec::new(),
        listed => listed?,
    };
    for entry in entries {
        let name = entry.file_name().unwrap_or_default();
        if name.to_string_lossy().starts_with(&prefix) {
            parts.push(entry);
        }
    }
    parts.sort();
    Ok(parts)
}

pub(super) fn in_folder(path: &Path, source: io::Error) -> FolderError {
    FolderError::at(path.join(SHARDS))(source)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shard_moved_by_another_process_is_accepted() {
        let folder = tempfile::tempdir().unwrap();
        let (file, corrupted) = (folder.path().join("0"), folder.path().join(DAMAGED));
        std::fs::File::create(&file).unwrap();
        set_aside(&file, &corrupted).unwrap();
        set_aside(&file, &corrupted).unwrap();
        assert!(corrupted.join("0").exists() && !file.exists());
    }
}
