//! Ensembles: what `simulate`, `sweep`, `resume` and `repeat` have in common.
mod arguments;
pub mod input;
mod making;

pub use arguments::{MAX_TICKS, MakingOptions, ProgramOptions, RUNS};
pub use making::{Ensemble, judge, run, stopped};
