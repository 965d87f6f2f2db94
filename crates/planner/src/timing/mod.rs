//! Schedules and their estimated times.
pub(crate) mod makespan;
pub(crate) mod precedence;
pub(crate) mod rate_law;
pub(crate) mod schedule;
