//! How a block moves, for whoever sets a world up by hand or looks on.
use nalgebra::{UnitQuaternion, Vector3};

/// Where a block is and how it moves, in block units: side 1, tick 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// Of the centre \[side\], from the centre of the plate's upper side.
    pub position: Vector3<f64>,
    /// Own directions to the structure's.
    pub orientation: UnitQuaternion<f64>,
    /// Of the centre \[side / tick\].
    pub velocity: Vector3<f64>,
    /// Angular velocity, in the structure's frame \[rad / tick\].
    pub spin: Vector3<f64>,
}

impl BodyState {
    /// A block at rest, its own directions those of the structure.
    pub fn at_rest(position: Vector3<f64>) -> BodyState {
        BodyState {
            position,
            orientation: UnitQuaternion::identity(),
            velocity: Vector3::zeros(),
            spin: Vector3::zeros(),
        }
    }
}
