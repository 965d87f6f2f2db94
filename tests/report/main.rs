//! The page that `stochc report` writes: its numbers, its figures, and what it does with bad input.
#![allow(
    clippy::disallowed_methods,
    reason = "the tests read what the command has written"
)]
mod aggregates;
mod command;
mod figures;
mod hostile;
mod layout;
mod maps;
mod numbers;
mod page;
mod sample;
#[path = "../command/stochc.rs"]
#[allow(dead_code, reason = "shared with the tests of the command")]
mod stochc;
mod tables;
