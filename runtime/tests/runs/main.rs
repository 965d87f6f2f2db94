//! Tests the execution of event tables in each kind of world: control, recording, checkpoints,
//! reproducibility, and agreement between worlds.
#[macro_use]
#[path = "../scenes/mod.rs"]
mod scenes;

mod agreement;
mod control;
mod execution;
mod faults;
mod identity;
mod rate;
mod retries;
mod shuffle;
mod state;
mod statistics;
mod strength;
#[path = "../tables/mod.rs"]
mod tables;
mod times;
