//! Recording of a run: positions of all blocks, and all events.
//!
//! A recording is a file of the results folder; `docs/guides/replay.md` describes its bytes. It is
//! written chunk by chunk during the run, so that long runs need no more memory than short ones.
//! Coordinates have 16 bits, which suffices for display. Equal runs have equal recordings, bit for
//! bit.
mod chunk;
mod format;
mod read;
mod selection;
mod write;

pub use format::{RecordingError, RecordingHeader, is_file};
pub use read::{Frame, Outline, Places, Recording, each_places};
pub use selection::Selection;
pub use stochc_runtime::observe::TimedEvent;
pub use write::Recorder;

/// Default number of ticks between two frames.
pub const EVERY: u32 = 4;

/// Returns the path of a run's recording in a results folder: `recordings/PROGRAM-RUN.rec`. Both
/// numbers start at 0.
pub fn path(folder: &std::path::Path, program: usize, run: u64) -> std::path::PathBuf {
    folder
        .join(crate::folder::RECORDINGS)
        .join(format!("{program}-{run}.rec"))
}
