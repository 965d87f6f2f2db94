//! Ensembles on a real Slurm: `tests/cluster/run` starts it, with two emulated nodes on this machine. After a failure,
//! a second `stochc shard submit` completes the ensemble, the same to the byte as on one machine.
#![cfg(target_os = "linux")]
#![allow(
    clippy::disallowed_methods,
    reason = "the tests look at what the command has written, and wait for others"
)]
mod emulated;
mod recovering;
#[path = "../skipped/mod.rs"]
mod skipped;
mod submitting;
