//! Reports of small ensembles: their numbers, their figures, and hostile input.
#![allow(
    clippy::disallowed_methods,
    reason = "the tests read programs from the disk"
)]
mod figures;
mod hostile;
mod layout;
mod numbers;
mod page;
mod reading;
mod sample;
mod trade;
