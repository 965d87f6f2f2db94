//! Speed against accuracy: a report on a sweep over settings.
//!
//! [`candidates()`] lists the settings that `stochc trade` compares. [`Trade`] compares the settings of any sweep with
//! the finest of them, from the runs of its results folder and the CPU time that these took.
mod advice;
mod assessment;
mod candidates;
mod convergence;
mod ranking;
mod result;
mod sample;

pub use assessment::TradeTally;
pub use candidates::{FINEST, candidates};
pub use convergence::{CLOSE, Convergence, Doubling};
pub use ranking::{Ranked, Verdict};
pub use result::{CandidateResult, ProgramResult, Reference, Trade, TradedProgram};
