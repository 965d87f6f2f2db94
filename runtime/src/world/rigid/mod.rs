//! Rigid cubes by a custom kernel for dilute suspensions.
//!
//! It supports the same scenes and magnets as [`super::rapier`], in single or double precision.
//! Most blocks fly freely most of the time. A free block costs only its random draws and its
//! motion: collision detection covers only neighbours, and rotations are computed on access.
mod bodies;
mod cell_list;
mod collision_detection;
mod free_flight;
mod integrator;
mod local_steps;
mod motion_groups;
mod narrow_phase;
mod neighbour_list;
mod quaternion;
mod simd;
mod solver;

use nalgebra::Vector3;
use stochc_control::Orientation;
use stochc_ir::Cell;
use stochc_ir::scene::Scene;
use stochc_ir::state::{State, StateError, StateReader, StateWriter};
use stochc_ir::table::Plate;

use super::delegate::delegate;
use super::stepper::Stepper;
use super::{BlockFace, BodyState, Docking, Fault, FreeBond, SceneError, SpatialWorld, World};
use crate::settings::{Precision, Settings};
#[cfg(test)]
pub(super) use bodies::Bodies;
use integrator::Kernel;

/// World of rigid cubes.
pub struct RigidWorld(ByPrecision);

enum ByPrecision {
    Single(Box<Stepper<Kernel<f32>>>),
    Double(Box<Stepper<Kernel<f64>>>),
}

/// Runs an expression with the world of either precision.
macro_rules! either {
    (new $precision:expr, $stepper:expr) => {
        match $precision {
            Precision::Single => ByPrecision::Single(Box::new($stepper)),
            Precision::Double => ByPrecision::Double(Box::new($stepper)),
        }
    };
    ($world:expr, $stepper:ident => $what:expr) => {
        match $world {
            ByPrecision::Single($stepper) => $what,
            ByPrecision::Double($stepper) => $what,
        }
    };
}

delegate!(RigidWorld, either);
