//! Tests ensembles with a real Slurm. `tests/cluster/run` starts it, with two emulated nodes on
//! this machine. After a failure, a second `stochc shard submit` completes the ensemble. The result
//! equals a result made on one machine, byte for byte.
#![cfg(target_os = "linux")]
#![allow(
    clippy::disallowed_methods,
    reason = "the tests read files of the command and wait for processes"
)]
mod emulated;
mod recovering;
#[path = "../skipped/mod.rs"]
mod skipped;
mod submitting;
