//! Waiting times of open faces, from their surroundings.
//!
//! A capture is a race of arrivals, each followed by a docking. [`Rates`] are calibrated for a
//! scene. Their law gives the arrival rate and the docking time of a face from the [`Surroundings`]
//! of its cell. [`Wait`] is the resulting distribution.
//!
//! ```
//! use stochc_ir::{Cell, Face};
//! use stochc_estimate::{Neighbourhood, Parameters, around};
//!
//! let wait = |is_full: &dyn Fn(Cell) -> bool| {
//!     let cell = Cell::new(0, 0, 9);
//!     let near = Neighbourhood::new(cell, is_full);
//!     Parameters::TYPICAL.wait(&around(cell, Face::Up, near, |_| None)).mean()
//! };
//! let tower = |cell: Cell| (cell.x, cell.y) == (0, 0) && cell.z < 9;
//! let beside_a_wall = |cell: Cell| tower(cell) || cell.x == 1;
//! assert!(wait(&beside_a_wall) < wait(&tower));
//! ```
mod cost;
mod geometry;
mod waits;

pub use cost::{
    CaptureCost, CaptureState, Cost, EventState, NoCaptureStates, OpenCapture, PartialRun,
    PhaseCost, ProgramParts, RemainingTime, SerialCapture, capture_states, estimate,
    estimate_without_timeouts, reference_count, remaining_time, serial_captures, times_out_rarely,
};
pub use geometry::accessibility::{offsets, sees};
pub use geometry::gap::{beside_gap, gap_entrances};
pub use geometry::interaction::Interaction;
pub use geometry::neighbourhood::{Neighbourhood, SIGHT};
pub use geometry::rivals::{Rivalry, Rivals, rivalry, rivals};
pub use geometry::surroundings::{around, feature_cells};
pub use waits::docking_time::STAGES;
pub use waits::first_guess::GUESS_ERROR;
pub use waits::head_start::{HeadStart, HeadStarts, ReleaseNearby, relative};
pub use waits::held_out::{HeldOut, InaccurateRates, MAX_HELD_OUT_ERROR};
pub use waits::law::{KindFactor, Parameter, Parameters, Surroundings};
pub use waits::lower_bound::{LowerBoundReason, LowerBoundReasons};
pub use waits::rates::{Coverage, FORMAT, Rates, UnreadableRates, density_in};
pub use waits::times::{Times, quantile};
pub use waits::wait::Wait;

/// Digest of this crate's sources. Two builds with equal digests compute equal results.
pub const SOURCES: &str = env!("STOCHC_SOURCES");
