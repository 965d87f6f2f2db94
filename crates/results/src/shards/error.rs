//! Why pieces are not made or put together, and the way out.
use std::path::{Path, PathBuf};

use stochc_files::shell::file as shell_file;
use stochc_text::listed;

use super::MAX_SHARDS;
use crate::{EnsembleError, FolderError, JournalError};

/// Why something was refused; whatever was there is as it was.
#[derive(Debug, thiserror::Error)]
pub enum ShardError {
    /// A number of pieces that cannot be.
    #[error(
        "cannot split {runs} runs into {asked} shards; a shard has at least one run, and {MAX_SHARDS} shards are the limit"
    )]
    Uncuttable {
        /// How many were asked for.
        asked: u64,
        /// Runs of all programs together.
        runs: u64,
    },
    /// It holds runs already, in one piece.
    #[error(
        "`{path}` holds {done} runs of this ensemble already; resume it with `stochc resume {}`, or choose another folder",
        shell_file(&.path.to_string_lossy())
    )]
    HoldsRuns {
        /// The folder.
        path: PathBuf,
        /// How many.
        done: usize,
    },
    /// It is cut in another way.
    #[error(
        "`{path}` is split into {there} shards of {runs} runs of each program; ask for the same, or choose another folder"
    )]
    OtherCut {
        /// The folder.
        path: PathBuf,
        /// How many pieces it has.
        there: u64,
        /// Runs of each program for which it was cut.
        runs: u64,
    },
    /// There are no pieces.
    #[error(
        "`{path}` has no shards: it holds {done} of {total} runs, which `stochc show {}` prints{}",
        shell_file(&.path.to_string_lossy()),
        if .done < .total { "; `stochc shard new` splits a new folder" } else { "" }
    )]
    NotCut {
        /// The folder.
        path: PathBuf,
        /// Runs that it holds.
        done: u64,
        /// Runs that are asked for.
        total: u64,
    },
    /// `shards.json` cannot be used.
    #[error(
        "cannot use `shards.json` in `{path}`: {reason}; if `stochc fsck {} --repair` does not repair it, `stochc shard new` \
         with the same programs and options writes it again and keeps the shards",
        shell_file(&.path.to_string_lossy())
    )]
    Unreadable {
        /// The folder.
        path: PathBuf,
        /// Why, in words.
        reason: String,
    },
    /// There is no such piece.
    #[error("there is no shard {number}; shards are 0 to {last}")]
    NoSuchPiece {
        /// The number that was asked for.
        number: u64,
        /// The last that there is.
        last: u64,
    },
    /// Files in the place of pieces are of something else.
    #[error(
        "`{path}`: {}; move these files elsewhere, and run these shards: {}",
        list_reasons(.pieces),
        commands(.path, .pieces.iter().map(|(number, _)| *number))
    )]
    Foreign {
        /// The folder.
        path: PathBuf,
        /// The numbers of the pieces, and what the files are.
        pieces: Vec<(u64, String)>,
    },
    /// Some pieces are not there, or damaged.
    #[error(
        "`{path}`: {} of {of} shards are missing or corrupted ({}); run them: {}",
        .pieces.len(),
        list_numbers(.pieces),
        commands(.path, .pieces.iter().copied())
    )]
    Missing {
        /// The folder.
        path: PathBuf,
        /// Their numbers.
        pieces: Vec<u64>,
        /// How many there are.
        of: u64,
    },
    /// A run could not be made or kept.
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

/// Pieces that are told; of more, how many there are.
const TOLD: usize = 10;

fn list_reasons(pieces: &[(u64, String)]) -> String {
    let each = pieces.iter().take(TOLD);
    let each: Vec<String> = each
        .map(|(number, what)| format!("shard {number} {what}"))
        .collect();
    match pieces.len().saturating_sub(TOLD) {
        0 => each.join("; "),
        more => format!("{} and {more} more", each.join("; ")),
    }
}

fn list_numbers(pieces: &[u64]) -> String {
    let each: Vec<String> = pieces.iter().take(TOLD).map(u64::to_string).collect();
    listed(&each, pieces.len())
}

/// Pieces whose numbers stand in a command; those of more are asked for.
const NAMED: usize = 100;

fn commands(path: &Path, pieces: impl ExactSizeIterator<Item = u64>) -> String {
    let folder = shell_file(&path.to_string_lossy());
    let count = pieces.len();
    let numbers: Vec<String> = pieces
        .take(NAMED)
        .map(|number| number.to_string())
        .collect();
    match count {
        1 => format!("`stochc shard run {folder} {}`", numbers[0]),
        ..=NAMED => format!(
            "`for i in {}; do stochc shard run {folder} $i; done`",
            numbers.join(" ")
        ),
        // What is damaged behind its first line is named once it is moved aside.
        _ => format!(
            "`stochc fsck {folder} --repair; for i in $(stochc shard status {folder} --missing); do stochc shard run {folder} $i; done`"
        ),
    }
}
