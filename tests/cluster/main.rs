//! Ensembles on a real Slurm: `tests/cluster/run` starts it, with two emulated nodes on this machine. Whatever goes wrong
//! in between, the folder is that of one machine to the byte, or what is missing is named.
#![cfg(target_os = "linux")]
#![allow(
    clippy::disallowed_methods,
    reason = "the tests look at what the command has written, and wait for others"
)]
mod emulated;
mod failing;
mod following;
mod recovering;
#[path = "../skipped/mod.rs"]
mod skipped;
