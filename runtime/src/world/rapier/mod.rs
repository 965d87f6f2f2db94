//! Full rigid bodies by the engine Rapier: the reference model.
//!
//! All cubes with rotation, contacts and friction, in single precision. A fluid
//! acts on each block alone: none feels its neighbours' wakes. Contacts are as soft as the
//! engine makes them, and with one substep a tick that is soft: see [`Settings`](crate::Settings).
mod bodies;
mod convert;
mod engine;
mod integrator;
mod joints;

use integrator::Rapier;

use super::stepper::Stepper;

/// A world of rigid cubes.
pub type RapierWorld = Stepper<Rapier>;
