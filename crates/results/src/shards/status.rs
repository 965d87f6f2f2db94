//! Status of shards.
use std::collections::BTreeMap;
use std::io::{self, BufRead as _, BufReader};
use std::path::Path;

use serde::Serialize;
use stochc_files as files;
use stochc_files::disk;

use super::ShardError;
use super::shard::{ShardFile, identify, in_folder, read};
use super::split::{Split, build, is_joined, shard_file};
use crate::Manifest;
use crate::folder::SHARDS;
use crate::integrity::{FileIntegrity, Integrity};

/// Status of all shards of an ensemble.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ShardStatus {
    /// Number of shards.
    pub shards: u64,
    /// Number of runs of all programs.
    pub runs: u64,
    /// State of each shard, by number.
    pub states: Vec<ShardState>,
}

/// State of a shard, judged by the first line of its file. [`merge`](super::merge()) and
/// [`verify`](crate::integrity::verify) read all lines.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "state")]
pub enum ShardState {
    /// The shard is complete.
    Whole,
    /// The shard is incomplete. A process is running it or was stopped.
    Begun {
        /// Number of finished runs. It may include runs that occur twice.
        runs: u64,
    },
    /// The shard is missing.
    Missing,
    /// The file of the shard is corrupted.
    Corrupted {
        /// Reason why the file is corrupted.
        reason: String,
    },
    /// The file belongs to another ensemble or split.
    Foreign {
        /// Description of the difference to the expected file.
        reason: String,
    },
}

impl ShardStatus {
    /// Returns the numbers of the incomplete shards in order.
    pub fn missing(&self) -> impl Iterator<Item = u64> {
        let states = (0..).zip(&self.states);
        let missing = states.filter(|(_, state)| **state != ShardState::Whole);
        missing.map(|(number, _)| number)
    }
}

/// Returns the status of all shards of an ensemble, judged by their first lines.
///
/// # Errors
///
/// If the ensemble is not split, or cannot be read.
pub fn status(path: &Path) -> Result<ShardStatus, ShardError> {
    let (manifest, split) = Split::require(path)?;
    let begun = begun(path).map_err(|source| in_folder(path, source))?;
    // A killed `merge` may have removed some shards after the journal was complete.
    let is_joined = is_joined(path, &manifest)?;
    let state = |number: u64| {
        if is_joined {
            return Ok(ShardState::Whole);
        }
        let header = split.header(build(&manifest), number);
        Ok(match identify(&shard_file(path, number), &header)? {
            ShardFile::Whole => ShardState::Whole,
            ShardFile::Corrupted(reason) => ShardState::Corrupted { reason },
            ShardFile::Foreign(reason) => ShardState::Foreign { reason },
            ShardFile::Nothing => match begun.get(&number) {
                Some(&runs) => ShardState::Begun { runs },
                None => ShardState::Missing,
            },
        })
    };
    let states = (0..split.shards).map(state);
    let states = states.collect::<Result<_, ShardError>>()?;
    Ok(ShardStatus {
        shards: split.shards,
        runs: manifest.total(),
        states,
    })
}

/// Returns the number of finished runs of each incomplete shard. The keys are the numbers of the
/// shards.
fn begun(path: &Path) -> io::Result<BTreeMap<u64, u64>> {
    let mut begun = BTreeMap::new();
    let entries = match disk::list(&path.join(SHARDS)) {
        Ok(entries) => entries,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(begun),
        Err(error) => return Err(error),
    };
    for entry in entries {
        let number = entry.file_name().and_then(|name| {
            let (number, what) = name.to_str()?.split_once('.')?;
            what.starts_with("part-").then(|| number.parse().ok())?
        });
        if let Some(number) = number {
            // The first line is the header.
            let lines = lines(&entry).unwrap_or_default().saturating_sub(1);
            *begun.entry(number).or_default() += lines;
        }
    }
    Ok(begun)
}

fn lines(file: &Path) -> io::Result<u64> {
    let mut file = BufReader::with_capacity(1 << 16, files::open(file)?);
    let mut count = 0;
    loop {
        let part = file.fill_buf()?;
        if part.is_empty() {
            return Ok(count);
        }
        count += part.iter().filter(|byte| **byte == b'\n').count() as u64;
        let read = part.len();
        file.consume(read);
    }
}

/// Reads all existing shards completely and returns their integrity.
pub(crate) fn health(path: &Path, manifest: &Manifest, split: &Split) -> Vec<FileIntegrity> {
    let health = |number: u64| {
        let file = shard_file(path, number);
        let header = split.header(build(manifest), number);
        let jobs = split.jobs(manifest.total(), number);
        let health = match read(&file, &header, manifest, &jobs, |_| Ok(())) {
            Ok(ShardFile::Nothing) => return None,
            Ok(ShardFile::Whole) => Integrity::Valid,
            Ok(ShardFile::Corrupted(reason) | ShardFile::Foreign(reason)) => {
                Integrity::Corrupted(vec![reason])
            }
            Err(error) => Integrity::Corrupted(vec![error.to_string()]),
        };
        let name = format!("{SHARDS}/{number}.jsonl");
        Some(FileIntegrity { name, health })
    };
    (0..split.shards).filter_map(health).collect()
}
