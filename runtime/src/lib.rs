//! Event tables and a scene to runs.
pub mod record;
