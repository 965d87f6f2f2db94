//! The rate model: capture times follow from the surroundings of each face, and nothing moves.
//!
//! Each open face has a hazard by the rate model of [`stochc_estimate`]. The faces compete by the
//! next-reaction method, with hazards that change with the age of a face. Ticks without captures
//! are skipped.
//!
//! # Source
//!
//! M. A. Gibson and J. Bruck (2000).
mod event_queue;
mod open_face_hazards;
mod rate_world;
mod waits;

pub use rate_world::RateWorld;
