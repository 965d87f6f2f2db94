//! Why a journal is not used.
use std::io;

/// Why a journal cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// Its first line names another ensemble, or is no such line.
    #[error(
        "`journal.jsonl` does not belong to `manifest.json` beside it; \
         move both to where they came from, or choose another folder; if one is damaged, `stochc fsck --repair` may help"
    )]
    Foreign,
    /// Somebody has written to it while it was read.
    #[error(
        "`journal.jsonl` has changed while it was read; do this again when nobody writes to the folder"
    )]
    Changed,
    /// It could not be read or written.
    #[error("cannot keep finished runs in `journal.jsonl`: {0}")]
    Io(#[from] io::Error),
}
