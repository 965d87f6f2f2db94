//! Finished ensembles in figures: what each capture was waited for, and what decided the time of each run.
//!
//! [`reported_program::Input`]s, which somebody has read from results folders, become subjects: a program of a folder with its runs.
//! Each event of a run gets its moments (`events.rs`) and the run its critical path (`critical_path.rs`); the rest sums them up.
pub(crate) mod critical_path;
mod decisive_events;
pub(crate) mod events;
pub(crate) mod maps;
pub(crate) mod pairwise;
pub(crate) mod reported_program;
pub(crate) mod sweep;
pub(crate) mod waits;
