//! Ensembles from outside: what is kept, what is refused, and what the tables say.
#![allow(clippy::disallowed_methods, reason = "tests read and write files")]
mod checkpoints;
mod damaged;
mod faults;
mod interrupted;
#[path = "../../../../tests/pages/mod.rs"]
mod pages;
mod refused;
mod shards;
mod tables;
mod world;
