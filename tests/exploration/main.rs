//! Event tables in every order of events.
mod faults;
mod holders;
mod mutants;
mod orders;
mod physical;
mod programs;
#[path = "../random/mod.rs"]
mod random;
mod reach;
mod turns;
