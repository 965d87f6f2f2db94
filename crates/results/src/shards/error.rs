//! Errors of shards, with suggestions.
use std::path::{Path, PathBuf};

use stochc_files::shell::file as shell_file;
use stochc_text::listed;

use super::MAX_SHARDS;
use crate::{EnsembleError, FolderError, JournalError};

/// Error of a shard. Existing files remain unchanged.
#[derive(Debug, thiserror::Error)]
pub enum ShardError {
    /// The ensemble cannot be split into this number of shards.
    #[error(
        "cannot split {runs} runs into {requested} shards; a shard has at least one run, and {MAX_SHARDS} shards are the limit"
    )]
    InvalidSplit {
        /// Requested number of shards.
        requested: u64,
        /// Number of runs of all programs.
        runs: u64,
    },
    /// The folder already contains runs that are not in shards.
    #[error(
        "`{path}` holds {done} runs of this ensemble already; resume it with `stochc resume {}`, or choose another folder",
        shell_file(&.path.to_string_lossy())
    )]
    HoldsRuns {
        /// Results folder.
        path: PathBuf,
        /// Number of these runs.
        done: usize,
    },
    /// The folder is already split into another number of shards.
    #[error(
        "`{path}` is split into {there} shards of {runs} runs of each program; ask for the same, or choose another folder"
    )]
    OtherSplit {
        /// Results folder.
        path: PathBuf,
        /// Number of shards of the existing split.
        there: u64,
        /// Runs of each program in the existing split.
        runs: u64,
    },
    /// The ensemble is not split into shards.
    #[error(
        "`{path}` has no shards: it holds {done} of {total} runs, which `stochc show {}` prints{}",
        shell_file(&.path.to_string_lossy()),
        if .done < .total { "; `stochc shard new` splits a new folder" } else { "" }
    )]
    NotSplit {
        /// Results folder.
        path: PathBuf,
        /// Number of finished runs in the shards.
        done: u64,
        /// Number of requested runs.
        total: u64,
    },
    /// `shards.json` cannot be used.
    #[error(
        "cannot use `shards.json` in `{path}`: {reason}; if `stochc fsck {} --repair` does not repair it, `stochc shard new` \
         with the same programs and options writes it again and keeps the shards",
        shell_file(&.path.to_string_lossy())
    )]
    Unreadable {
        /// Results folder.
        path: PathBuf,
        /// Reason why the split is invalid.
        reason: String,
    },
    /// No shard has this number.
    #[error("there is no shard {number}; shards are 0 to {last}")]
    NoSuchShard {
        /// Requested number of a shard.
        number: u64,
        /// Largest number of a shard.
        last: u64,
    },
    /// Files of shards belong to another ensemble, split or build.
    #[error(
        "`{path}`: {}; move these files elsewhere, and run these shards: {}",
        list_reasons(.shards),
        commands(.path, .shards.iter().map(|(number, _)| *number))
    )]
    Foreign {
        /// Results folder.
        path: PathBuf,
        /// Numbers of these shards, each with a description of its file.
        shards: Vec<(u64, String)>,
    },
    /// Some shards are missing or corrupted.
    #[error(
        "`{path}`: {} of {total} shards are missing or corrupted ({}); run them: {}",
        .shards.len(),
        list_numbers(.shards),
        commands(.path, .shards.iter().copied())
    )]
    Missing {
        /// Results folder.
        path: PathBuf,
        /// Numbers of these shards.
        shards: Vec<u64>,
        /// Number of all shards.
        total: u64,
    },
    /// A run of the shard could not be made or stored.
    #[error(transparent)]
    Run(#[from] EnsembleError),
    /// The folder cannot be used.
    #[error(transparent)]
    Folder(#[from] FolderError),
}

impl From<JournalError> for ShardError {
    fn from(error: JournalError) -> ShardError {
        ShardError::Folder(error.into())
    }
}

/// Largest number of shards that a message lists.
const MAX_LISTED: usize = 10;

fn list_reasons(shards: &[(u64, String)]) -> String {
    let each = shards.iter().take(MAX_LISTED);
    let each: Vec<String> = each
        .map(|(number, what)| format!("shard {number} {what}"))
        .collect();
    match shards.len().saturating_sub(MAX_LISTED) {
        0 => each.join("; "),
        more => format!("{} and {more} more", each.join("; ")),
    }
}

fn list_numbers(shards: &[u64]) -> String {
    let each: Vec<String> = shards.iter().take(MAX_LISTED).map(u64::to_string).collect();
    listed(&each, shards.len())
}

/// Largest number of shards in a suggested command line. For more shards, the command determines
/// them itself.
const NAMED: usize = 100;

fn commands(path: &Path, shards: impl ExactSizeIterator<Item = u64>) -> String {
    let folder = shell_file(&path.to_string_lossy());
    let count = shards.len();
    let numbers: Vec<String> = shards
        .take(NAMED)
        .map(|number| number.to_string())
        .collect();
    match count {
        1 => format!("`stochc shard run {folder} {}`", numbers[0]),
        ..=NAMED => format!(
            "`for i in {}; do stochc shard run {folder} $i; done`",
            numbers.join(" ")
        ),
        // Corrupted shards are moved aside first and then count as missing.
        _ => format!(
            "`stochc fsck {folder} --repair; for i in $(stochc shard status {folder} --missing); do stochc shard run {folder} $i; done`"
        ),
    }
}
