//! Full rigid bodies by the engine Rapier: the reference model.
//!
//! All cubes with rotation, contacts and friction, in single precision. A fluid
//! acts on each block alone: none feels its neighbours' wakes. Contacts are as soft as the
//! engine makes them, and with one substep a tick that is soft: see [`Settings`].
mod bodies;
mod convert;
mod engine;
mod integrator;
mod joints;

use integrator::Rapier;
use nalgebra::Vector3;
use stochc_ir::Cell;
use stochc_ir::scene::Scene;
use stochc_ir::state::{State, StateError, StateReader, StateWriter};
use stochc_ir::table::Plate;
use stochc_protocol::Orientation;

use super::delegate::delegate;
use super::stepper::Stepper;
use super::{Arena, BlockFace, BodyState, Docking, Fault, FreeBond, SceneError, World};
use crate::settings::Settings;

/// A world of rigid cubes.
pub struct RapierWorld(Box<Stepper<Rapier>>);

/// In single precision only, which [`Rapier`] insists on.
macro_rules! only {
    (new $precision:expr, $stepper:expr) => {
        Box::new($stepper)
    };
    ($world:expr, $stepper:ident => $what:expr) => {{
        let $stepper = $world;
        $what
    }};
}

delegate!(RapierWorld, only);
