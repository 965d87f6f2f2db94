//! Event tables and a scene to runs.
pub mod control;
pub mod draw;
pub mod orientation;
pub mod record;
pub mod world;
