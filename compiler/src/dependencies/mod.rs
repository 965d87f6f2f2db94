//! The dependency graph and orders of events.
pub mod face_turns;
pub mod graph;
pub mod order;
