//! Options and steps that `simulate`, `sweep`, `resume` and `repeat` share.
mod arguments;
pub mod input;
mod making;

pub use arguments::{MAX_TICKS, MakingOptions, ProgramOptions, RUNS};
pub use making::{Ensemble, judge, run, stopped};
