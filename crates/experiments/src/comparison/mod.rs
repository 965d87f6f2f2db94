//! Compares programs by their completion times.
mod figures;
mod pairwise;
mod times;

pub use figures::{Comparison, ComparisonTally, Pair, PhaseTime, ProgramSummary, Time, last_seen};
pub use pairwise::{ComparedProgram, PairwiseResult, PairwiseTest, TimeUnit, pairwise_tests};
pub use times::{completion_status, completion_time, median_run, phase_time, sort_by_time};
