//! Tests event tables in every order of events.
#![allow(clippy::disallowed_methods, reason = "tests read and write files")]
mod faults;
mod holders;
mod mutants;
mod mutations;
mod orders;
#[path = "../../../../tests/pages/mod.rs"]
mod pages;
mod physical;
mod programs;
#[path = "../../../../compiler/tests/compiler/random.rs"]
mod random;
mod reach;
mod retries;
mod turns;
mod verification;
