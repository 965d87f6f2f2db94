//! Errors of journals.
use std::io;

/// Error of a journal.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// The first line of the journal is invalid or names another ensemble.
    #[error(
        "`journal.jsonl` does not belong to the `manifest.json` in its folder; \
         move both back to their folders, or choose another folder; if one is damaged, `stochc fsck --repair` may help"
    )]
    Foreign,
    /// The journal was changed while it was read.
    #[error(
        "`journal.jsonl` changed while it was read; repeat this when no process is writing to the folder"
    )]
    Changed,
    /// The journal could not be read or written.
    #[error("cannot store finished runs in `journal.jsonl`: {0}")]
    Io(#[from] io::Error),
}
