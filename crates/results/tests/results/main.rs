//! Tests ensembles through the interface of the crate: storage, rejected folders, and tables.
#![allow(clippy::disallowed_methods, reason = "tests read and write files")]
mod checkpoints;
mod corrupted;
mod experiment_log;
mod faults;
mod interrupted;
#[path = "../../../../tests/experiment_log/mod.rs"]
mod logs;
#[path = "../../../../tests/pages/mod.rs"]
mod pages;
mod refused;
mod remaining;
mod shards;
mod tables;
mod world;
