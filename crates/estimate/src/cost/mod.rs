//! Estimates the completion time of a program without simulating it.
//!
//! Depth and width of the phases follow from the graph alone. Times need the rates of the scene.
//! Each capture gets a waiting time for the structure at its turn. Waiting times and message delays
//! are summed along the graph. Runs of the rate model are more detailed: there, cells next to an
//! open face fill while it waits.
mod capture_states;
mod costs;
mod drawn_times;
mod estimation;
mod events;
mod exponential;
mod message_times;
mod occupancy;
mod partial_run;
mod sampling;
mod scarcity;
mod serial;
mod steps;
mod timed_phase;
mod waits;

pub use capture_states::{CaptureState, NoCaptureStates, OpenCapture, capture_states};
pub use costs::{CaptureCost, Cost, PhaseCost};
pub use estimation::{estimate, estimate_without_timeouts, remaining_time, times_out_rarely};
pub use events::ProgramParts;
pub use partial_run::{EventState, PartialRun, RemainingTime};
pub use serial::{SerialCapture, reference_count, serial_captures};
