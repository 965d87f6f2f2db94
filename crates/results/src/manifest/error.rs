//! Errors of manifests.
use std::str::Utf8Error;

use super::limits::{FORMAT, MAX_PROGRAMS, MAX_RUNS};

/// Reason why a manifest cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ManifestError {
    /// The manifest is not UTF-8.
    #[error(transparent)]
    NotText(#[from] Utf8Error),
    /// The file is not the JSON of a manifest.
    #[error("it is not the manifest of an ensemble")]
    NotAManifest,
    /// The manifest has another format version.
    #[error("its format is {0}, and this is {FORMAT}")]
    OtherFormat(u32),
    /// A part is missing or invalid.
    #[error("it is damaged, {0}")]
    Corrupted(String),
    /// The manifest does not match the first line of the journal.
    #[error("it does not belong to the journal; nothing was changed")]
    NotOfTheJournal,
    /// The manifest contains no runs.
    #[error("it has no programs, or no runs")]
    Empty,
    /// The manifest has too many runs of each program.
    #[error("{0} runs of each program; at most {MAX_RUNS} are possible")]
    TooManyRuns(u64),
    /// The sweep has too many programs for a comparison of all pairs.
    #[error(
        "{0} programs that are all compared with each other; at most {MAX_PROGRAMS} are possible"
    )]
    TooManyPrograms(usize),
}
