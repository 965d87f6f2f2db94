//! Errors of journals.
use std::io;

/// Error of a journal.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// Its first line is invalid or identifies another ensemble.
    #[error(
        "`journal.jsonl` does not belong to the `manifest.json` in its folder; \
         move both to where they came from, or choose another folder; if one is damaged, `stochc fsck --repair` may help"
    )]
    Foreign,
    /// It was changed while it was read.
    #[error(
        "`journal.jsonl` changed while it was read; repeat this when no process is writing to the folder"
    )]
    Changed,
    /// It could not be read or written.
    #[error("cannot store finished runs in `journal.jsonl`: {0}")]
    Io(#[from] io::Error),
}
