//! Numbers of a scene from measured times: what physical constants do data speak for?
//!
//! Bayesian inference with a synthetic likelihood. A simulation has no likelihood that can be written down, but the mean and the
//! spread of its times can be simulated. Programs are run at points of the prior ([`Design`]); for each program these
//! statistics are interpolated by a quadratic polynomial in the numbers ([`Emulator`]), which knows its
//! own error; and the data are held against that ([`Posterior`]): S. N. Wood, Nature 466 (2010) 1102; M. J. Bayarri and others,
//! Technometrics 49 (2007) 138. Nothing here runs anything: who has points simulated is the caller's.
mod data;
mod design;
mod emulator;
mod observed;
mod posterior;
mod prior;
mod result;
mod simulated;
mod statistics;

pub use data::{DataError, MeasuredTimes, PileUp, Unit};
pub use design::Design;
pub use emulator::{Emulator, EmulatorPrediction};
pub use observed::Observed;
pub use posterior::{Marginal, Posterior};
pub use prior::Prior;
pub use result::{Fit, FittedProgram, Interval, Measurement, Prediction};
pub use simulated::Simulated;
