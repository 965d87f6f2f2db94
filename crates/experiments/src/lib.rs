//! Analysis of ensembles: comparison, sweeps, trades of accuracy for speed, calibration, fits and
//! optimization.
//!
//! Every result is a function of a manifest and its runs only.
pub mod calibration;
mod captures;
mod claims;
mod claims_without_runs;
mod comparison;
mod elasticity;
pub mod fit;
pub mod optimize;
mod outcome_counts;
pub mod resampling;
mod stamped_json;
pub mod statistics;
mod summary_tables;
pub mod sweep;
pub mod trade;

pub use captures::{CaptureKey, CaptureSummary, Repetitions, Waits, WaitsTally, captures};
pub use claims::{
    ClaimMethod, ClaimTesting, ClaimedQuantity, ModelError, TestedClaim, Verdict, test_claims,
};
pub use claims_without_runs::decide_claims;
pub use comparison::{
    ComparedProgram, Comparison, ComparisonTally, Pair, PairwiseResult, PairwiseTest, PhaseTime,
    ProgramSummary, Time, TimeUnit, completion_status, completion_time, last_seen, median_run,
    pairwise_tests, phase_time, sort_by_time,
};
pub use elasticity::{ElasticityRow, Estimate, elasticity};
pub use outcome_counts::OutcomeCounts;
pub use summary_tables::summary_table;
