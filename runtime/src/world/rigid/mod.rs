//! Full rigid cubes by a kernel of our own, made for dilute suspensions.
//!
//! The same scenes as the world of Rapier, in single or double precision, and the same rules for
//! magnets. Almost every block flies alone almost always, so that a free block costs its draws and
//! its flight, and nothing more: contacts are looked for among neighbours only, and orientations
//! are computed when somebody looks.
mod bodies;
mod detect;
mod flight;
mod grid;
#[expect(private_bounds, reason = "there are two precisions, `f32` and `f64`")]
mod kernel;
mod lanes;
mod neighbours;
mod overlap;
mod solver;
mod turn;

use super::stepper::Stepper;
#[cfg(test)]
pub(super) use bodies::Bodies;
use kernel::Kernel;

/// A world of rigid cubes in single precision, `f32`, or in double precision, `f64`.
pub type RigidWorld<R = f32> = Stepper<Kernel<R>>;
