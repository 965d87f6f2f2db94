//! Split of an ensemble into shards.
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use stochc_files::atomic::make_own_folder;
use stochc_files::budget::SHARDS as SHARDS_BUDGET;
use stochc_files::checksum::{self, LineIntegrity, Sum};
use stochc_files::read_file;

use super::{MAX_SHARDS, ShardError};
use crate::build::other_build;
use crate::folder::{JOURNAL, SHARDS, SHARDS_FILE};
use crate::folder::{replace, survey, write_checksums};
use crate::journal::line as journal_line;
use crate::journal::{self, JournalHeader, ShardHeader};
use crate::{Folder, FolderError, Manifest, Resume, this_build};

/// Split of an ensemble: `shards.json` in its folder.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Split {
    /// Identity of the ensemble's manifest.
    ensemble: String,
    /// Number of runs of each program.
    pub runs: u64,
    /// Number of shards.
    pub shards: u64,
}

/// Result of [`prepare`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prepared {
    /// The folder was created.
    New,
    /// The folder already had the same ensemble with the same split.
    Already,
}

/// Creates the folder of an ensemble at `path`, split into `shards` shards.
///
/// # Errors
///
/// Every error leaves existing files unchanged.
pub fn prepare(path: &Path, manifest: &Manifest, shards: u64) -> Result<Prepared, ShardError> {
    let split = Split {
        ensemble: manifest.identity(),
        runs: manifest.runs,
        shards,
    };
    let runs = manifest.total();
    if shards == 0 || shards > MAX_SHARDS.min(runs) {
        let requested = shards;
        return Err(ShardError::InvalidSplit { requested, runs });
    }
    if let Some(stored) = survey(path)? {
        same_build(path, &stored)?;
        if let Some(there) = Split::read(path)?
            && there != split
            && there.ensemble == split.ensemble
        {
            return Err(ShardError::OtherSplit {
                path: path.to_owned(),
                there: there.shards,
                runs: there.runs,
            });
        }
    }
    let mut folder = Folder::open_split(path, manifest, Resume::SameBuild)?;
    let is_cut = Split::read(path)?.is_some();
    if !folder.existing().is_empty() && !is_cut {
        return Err(ShardError::HoldsRuns {
            path: path.to_owned(),
            done: folder.existing().len(),
        });
    }
    if is_cut {
        return Ok(Prepared::Already);
    }
    folder.leave_foul_lines()?;
    folder.write_manifest()?;
    let shards = path.join(SHARDS);
    make_own_folder(&shards).map_err(FolderError::at(shards))?;
    split.write(path)?;
    Ok(Prepared::New)
}

/// Returns an error if another build made the ensemble, so that this build must not add runs.
pub(crate) fn same_build(path: &Path, stored: &Manifest) -> Result<(), FolderError> {
    if stored.builds == [this_build()] {
        Ok(())
    } else {
        Err(FolderError::OtherBuildOfShards {
            path: path.to_owned(),
            reason: other_build(&stored.builds)
                .unwrap_or_else(|| "several builds have made it".to_owned()),
        })
    }
}

impl Split {
    /// Reads the manifest of a folder and its split.
    ///
    /// # Errors
    ///
    /// If there is no ensemble, or the ensemble is not split.
    pub(crate) fn require(path: &Path) -> Result<(Manifest, Split), ShardError> {
        let manifest = survey(path)?.ok_or_else(|| FolderError::Absent(path.to_owned()))?;
        let Some(split) = Split::read(path)? else {
            let identity = manifest.identity();
            let stored = journal::read(&path.join(JOURNAL), &manifest, &identity)?;
            let (done, total) = (stored.finished.len() as u64, manifest.total());
            if done < total && path.join(SHARDS).exists() {
                return Err(unreadable(path, "it is not there"));
            }
            let path = path.to_owned();
            return Err(ShardError::NotSplit { path, done, total });
        };
        if (&split.ensemble, split.runs) != (&manifest.identity(), manifest.runs) {
            return Err(unreadable(path, "it belongs to another ensemble"));
        }
        if split.shards == 0 || split.shards > MAX_SHARDS.min(manifest.total()) {
            return Err(unreadable(path, "it says an impossible number of shards"));
        }
        Ok((manifest, split))
    }

    /// Reads the split of a folder, or returns `None` if there is none.
    pub(crate) fn read(path: &Path) -> Result<Option<Split>, ShardError> {
        let bytes = match read_file(&path.join(SHARDS_FILE), SHARDS_BUDGET) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(unreadable(path, &error.to_string())),
        };
        let line = bytes.strip_suffix(b"\n").unwrap_or_default();
        match (checksum::check(line), serde_json::from_slice(line)) {
            (LineIntegrity::Valid, Ok(split)) => Ok(Some(split)),
            _ => Err(unreadable(path, "it is damaged")),
        }
    }

    /// Writes the split into the folder of its ensemble. Also writes the checksums of the split and
    /// the manifest.
    pub(crate) fn write(&self, path: &Path) -> Result<(), FolderError> {
        let text = journal_line(self);
        replace(path, SHARDS_FILE, text.as_bytes())?;
        let sum = Sum::from_bytes(text.as_bytes());
        write_checksums(path, &[(SHARDS_FILE.to_owned(), sum)])
    }

    /// Returns the range of job numbers that belong to a shard. There are `total` jobs. The sizes
    /// of shards differ by at most one job.
    pub(super) fn jobs(&self, total: u64, shard: u64) -> Range<u64> {
        let begin = |shard: u64| {
            let share = u128::from(shard) * u128::from(total) / u128::from(self.shards);
            u64::try_from(share).unwrap_or(u64::MAX)
        };
        begin(shard)..begin(shard + 1)
    }

    /// Returns the first line of a shard that `build` makes.
    pub(super) fn header(&self, build: &str, number: u64) -> JournalHeader {
        let shard = ShardHeader {
            number,
            shards: self.shards,
            runs: self.runs,
            build: build.to_owned(),
        };
        JournalHeader::for_shard(&self.ensemble, shard)
    }
}

/// Returns the build that makes all shards of an ensemble.
pub(super) fn build(manifest: &Manifest) -> &str {
    match &manifest.builds[..] {
        [build] => build,
        _ => "several",
    }
}

/// Returns the path of a complete shard.
pub(super) fn shard_file(path: &Path, number: u64) -> PathBuf {
    path.join(SHARDS).join(format!("{number}.jsonl"))
}

fn unreadable(path: &Path, reason: &str) -> ShardError {
    ShardError::Unreadable {
        path: path.to_owned(),
        reason: reason.to_owned(),
    }
}

/// Returns whether the shards are obsolete because the journal already has all runs.
pub(super) fn is_joined(path: &Path, manifest: &Manifest) -> Result<bool, ShardError> {
    let stored = journal::read(&path.join(JOURNAL), manifest, &manifest.identity())?;
    Ok(stored.finished.len() as u64 == manifest.total())
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn every_job_is_in_one_shard(total in 1u64..500, shards in 1u64..500) {
            let shards = shards.min(total);
            let split = Split { ensemble: String::new(), runs: total, shards };
            let mut next = 0;
            for shard in 0..shards {
                let jobs = split.jobs(total, shard);
                let size = jobs.end - jobs.start;
                prop_assert_eq!(jobs.start, next);
                prop_assert!(size == total / shards || size == total.div_ceil(shards));
                next = jobs.end;
            }
            prop_assert_eq!(next, total);
        }
    }
}
