//! Tests that need several crates, but not the command.
#![allow(clippy::disallowed_methods, reason = "tests read and write files")]
mod claims_without_runs;
mod estimate;
mod executable;
mod findings;
mod fuzz_corpus;
mod gallery;
mod language;
mod mistakes;
#[path = "../../crates/control/tests/exploration/mutations.rs"]
mod mutations;
#[path = "../pages/mod.rs"]
mod pages;
#[path = "../../compiler/tests/compiler/random.rs"]
mod random;
mod random_programs;
mod sarif;
mod stages;
mod students;
mod vocabulary;
