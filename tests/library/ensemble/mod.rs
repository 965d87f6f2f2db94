//! Ensembles from outside: what is kept, what is refused, and what the tables say.
mod checkpoints;
mod damaged;
mod faults;
mod figures;
mod interrupted;
mod refused;
mod shards;
mod tables;
mod world;
