//! Rigid bodies by the engine Rapier: an independent check.
//!
//! All cubes have rotation, contacts and friction, in single precision. A fluid acts on each block
//! separately, without wakes of neighbours. The engine's contacts are compliant, most of all with
//! one substep per tick; see [`Settings`].
mod bodies;
mod convert;
mod engine;
mod integrator;
mod joints;

use integrator::Rapier;
use nalgebra::Vector3;
use stochc_control::Orientation;
use stochc_ir::Cell;
use stochc_ir::scene::Scene;
use stochc_ir::state::{State, StateError, StateReader, StateWriter};
use stochc_ir::table::Plate;

use super::delegate::delegate;
use super::stepper::Stepper;
use super::{BlockFace, BodyState, Docking, Fault, FreeBond, SceneError, SpatialWorld, World};
use crate::settings::Settings;

/// A world of rigid cubes.
pub struct RapierWorld(Box<Stepper<Rapier>>);

/// Gives access to the stepper, as required by `delegate!`. Ignores the precision, because
/// [`Rapier`] has only single precision.
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
