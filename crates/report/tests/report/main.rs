//! Tests reports of small ensembles: numbers, figures and hostile input.
#![allow(
    clippy::disallowed_methods,
    reason = "the tests read programs from the disk"
)]
mod comparison;
mod figures;
mod hostile;
mod layout;
mod numbers;
mod page;
mod reading;
mod sample;
mod trade;
#[allow(dead_code, reason = "tests of results use the rest")]
#[path = "../../../results/tests/results/world.rs"]
mod world;
