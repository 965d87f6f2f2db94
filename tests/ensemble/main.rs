//! Ensembles from outside: what is kept, what is refused, and what the tables say.
mod checkpoints;
mod damaged;
mod faults;
mod figures;
mod interrupted;
#[path = "../pages/mod.rs"]
mod pages;
mod refused;
mod shards;
mod tables;
mod world;
