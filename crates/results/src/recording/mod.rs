//! A run as it can be looked at again: where every block was, and all that happened.
//!
//! A recording is a file of the results folder; `docs/guides/replay.md` describes it byte by byte. It is
//! written while the run goes, chunk by chunk, so that a long run needs no more memory than a short
//! one. Places are kept in 16 bits, for looking and not for computing; a recording of the same run
//! is always the same, bit for bit.
mod chunk;
mod events;
mod format;
mod read;
mod selection;
mod write;

pub use events::TimedEvent;
pub use format::{RecordingError, RecordingHeader, is_file};
pub use read::{Frame, Outline, Places, Recording, each_places};
pub use selection::Selection;
pub use write::Recorder;

/// Ticks from one recorded place to the next, if nothing else is said.
pub const EVERY: u32 = 4;

/// Where a folder of results keeps the recording of a run: `recordings/PROGRAM-RUN.rec`, both
/// counted from 0.
pub fn path(folder: &std::path::Path, program: usize, run: u64) -> std::path::PathBuf {
    folder
        .join(crate::folder::RECORDINGS)
        .join(format!("{program}-{run}.rec"))
}
