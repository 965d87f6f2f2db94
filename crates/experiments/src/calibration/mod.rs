//! Calibration of the rates of a scene from physical runs.
//!
//! The simulated [`programs`] build growing structures. Every waiting time is an observation of the
//! rate law of [`stochc_estimate`], in surroundings that change during the wait. The parameters
//! maximize the likelihood, with a weak prior from typical scenes.
mod capture_calibration;
mod gas;
mod head_start;
mod held_out;
mod likelihood;
mod observation;
mod programs;

pub use capture_calibration::{Calibration, TooFew};
pub use gas::profile;
pub use programs::{PROGRAMS, programs};
