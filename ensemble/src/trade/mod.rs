//! What accuracy costs: programs at many settings, each held against a converged reference.
//!
//! `plan.rs` says which run comes next, [`Trade`] what came of them. Neither knows a clock or a
//! thread; [`measure()`] brings them.
mod advice;
mod assessment;
mod candidates;
mod convergence;
mod estimate;
mod measure;
mod measurement_journal;
mod plan;
mod ranking;
mod result;
mod sample;

pub use assessment::Conditions;
pub use candidates::{FINEST, base, candidates};
pub use convergence::{CLOSE, Convergence, Doubling};
pub use estimate::EstimatedSamples;
pub use measure::{MeasurementProgress, Setup, measure};
pub use measurement_journal::{MEASUREMENT_JOURNAL, MeasurementJournal, has_entries};
pub use plan::{CandidateOutcome, Extent};
pub use ranking::{Ranked, Verdict};
pub use result::{CandidateResult, FORMAT, MeasuredProgram, ProgramResult, Reference, Trade};
pub use sample::{End, Measured, Sample};
