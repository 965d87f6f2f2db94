//! Tests of the interpreter in C: one instance per block, bytes between them, next to the control
//! that `stochc` verifies.
#![allow(clippy::disallowed_methods, reason = "tests read and write files")]
#![cfg(unix)]
mod compiled;
mod control;
mod driver;
mod equal;
mod explored;
mod faults;
mod host;
#[allow(dead_code, reason = "other tests use more of it")]
#[path = "../../../compiler/tests/compiler/random.rs"]
mod random;
#[path = "../../../tests/skipped/mod.rs"]
mod skipped;
mod target;
