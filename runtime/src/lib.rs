//! Event tables and a scene to runs.
pub mod draw;
pub mod orientation;
pub mod record;
