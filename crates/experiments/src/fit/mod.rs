//! Fits of scene parameters to measured times.
//!
//! The method is Bayesian inference with a synthetic likelihood. A simulation has no explicit
//! likelihood, but the mean and spread of its times can be estimated. Programs are simulated at
//! points of the prior ([`Design`]). For each program, a quadratic polynomial interpolates these
//! statistics and estimates its own error ([`Emulator`]). The [`Posterior`] compares the data with
//! these predictions. The caller runs the simulations.
//!
//! # Source
//!
//! S. N. Wood, Nature 466, 1102 (2010); M. J. Bayarri and others, Technometrics 49, 138 (2007).
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
