//! List scheduling on mean waiting times: selects the cell that opens next.
//!
//! The most urgent eligible cell opens. Its predecessors must be present, a neighbour must have a
//! face available, and no open face may [jam with it](crate::space::crowding).
mod job;
mod phase;
mod phase_rules;
mod priorities;
mod scheduler;
mod state;

pub use job::{SchedulingJob, WAIT};
pub use priorities::Priorities;
