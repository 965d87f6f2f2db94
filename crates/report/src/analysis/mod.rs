//! Analysis of finished ensembles: waiting times of captures, and critical paths of runs.
//!
//! Each program of an [`Input`](reported_program::Input) becomes a reported program. Each event of
//! a run has its timing (`events.rs`), and each run its critical path (`critical_path.rs`). The
//! other modules aggregate them.
pub(crate) mod critical_path;
pub(crate) mod decisive_events;
pub(crate) mod events;
pub(crate) mod maps;
pub(crate) mod pairwise;
pub(crate) mod reported_program;
pub(crate) mod slow_runs;
pub(crate) mod sweep;
pub(crate) mod waits;
