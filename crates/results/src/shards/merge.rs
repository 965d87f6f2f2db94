//! Merges shards.
use std::io::{self, Write as _};
use std::path::Path;

use stochc_files::atomic::{Draft, Replaces, remove_own, sync_folder};
use stochc_files::disk;

use super::ShardError;
use super::shard::{ShardFile, in_folder, read};
use super::split::{Split, build, is_joined, shard_file};
use crate::checkpoint;
use crate::folder::lock;
use crate::folder::slurm_folder;
use crate::folder::{JOURNAL, SHARDS, SHARDS_FILE};
use crate::journal::JournalHeader;
use crate::journal::line as journal_line;
use crate::{Folder, FolderError, Further, Manifest, Resume};

/// Merges the shards of a folder, as if it had never been split. Returns the number of runs.
///
/// The function can be interrupted at any time and called again.
///
/// # Errors
///
/// If a shard is missing, corrupted, or of another ensemble. The folder is then unchanged.
pub fn merge(path: &Path, further: Further) -> Result<u64, ShardError> {
    let (_, split) = Split::require(path)?;
    let lock = lock(path)?;
    // Read again, now with exclusive access.
    let (manifest, _) = Split::require(path)?;
    if !is_joined(path, &manifest)? {
        join(path, &manifest, &split)?;
    }
    drop(lock);
    let folder = Folder::open_split(path, &manifest, Resume::MixedBuilds)?.with(further);
    folder.write_tables(folder.existing())?;
    checkpoint::clear(path, |_, _| false).map_err(|source| in_folder(path, source))?;
    clear(path, &split).map_err(|source| in_folder(path, source))?;
    Ok(manifest.total())
}

/// Creates the journal of the ensemble from the lines of all shards.
fn join(path: &Path, manifest: &Manifest, split: &Split) -> Result<(), ShardError> {
    let io = FolderError::at(path.join(JOURNAL));
    let mut draft = Draft::new(&path.join(JOURNAL), Replaces::Ordinary).map_err(&io)?;
    let header = JournalHeader::new(&manifest.identity());
    draft
        .write_all(journal_line(&header).as_bytes())
        .map_err(&io)?;
    let (mut missing, mut foreign) = (Vec::new(), Vec::new());
    for number in 0..split.shards {
        let file = shard_file(path, number);
        let (header, jobs) = (
            split.header(build(manifest), number),
            split.jobs(manifest.total(), number),
        );
        // Nothing is written unless all shards are valid.
        let is_wanted = missing.is_empty() && foreign.is_empty();
        let found = read(&file, &header, manifest, &jobs, |line| {
            if is_wanted {
                draft.write_all(line)?;
                draft.write_all(b"\n")
            } else {
                Ok(())
            }
        })?;
        match found {
            ShardFile::Whole => {}
            ShardFile::Nothing | ShardFile::Corrupted(_) => missing.push(number),
            ShardFile::Foreign(what) => foreign.push((number, what)),
        }
    }
    let path = path.to_owned();
    if !foreign.is_empty() {
        let shards = foreign;
        return Err(ShardError::Foreign { path, shards });
    }
    if !missing.is_empty() {
        return Err(ShardError::Missing {
            path,
            shards: missing,
            total: split.shards,
        });
    }
    Ok(draft.keep().map_err(io)?)
}

/// Removes the shards, then `shards.json`.
fn clear(path: &Path, split: &Split) -> io::Result<()> {
    remove_own(&path.join(SHARDS), |name| is_ours(name, split))?;
    slurm_folder::clear(path)?;
    disk::remove(&path.join(SHARDS_FILE))?;
    sync_folder(path)
}

/// Returns whether a file is a shard, or left over from a process that ran a shard.
fn is_ours(name: &str, split: &Split) -> bool {
    let Some((number, what)) = name.split_once('.') else {
        return false;
    };
    let is_number = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
    let is_shard = is_number
        && number
            .parse()
            .is_ok_and(|number: u64| number < split.shards);
    is_shard && (what == "jsonl" || what.starts_with("part-") || what.starts_with("draft-"))
}
