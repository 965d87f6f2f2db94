//! Trades: speed and accuracy of settings, from the results of a sweep over settings.
//!
//! [`candidates()`] lists the settings that `stochc trade` compares. A [`Trade`] compares the
//! settings of any sweep with the finest ones. It uses the runs of a results folder and their CPU
//! times.
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
