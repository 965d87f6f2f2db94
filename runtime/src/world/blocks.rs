//! Positions and motion of the blocks, as seen by forces, faces and bonds.
use nalgebra::{UnitQuaternion, Vector3};
use stochc_control::Orientation;

use super::real::{Real, cast};

/// Position and motion of a block in block units: block length 1, tick 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyState {
    /// Position of the centre, from the centre of the plate's upper side \[block lengths\].
    pub position: Vector3<f64>,
    /// Rotation from the block's axes to the structure's.
    pub orientation: UnitQuaternion<f64>,
    /// Velocity of the centre \[block lengths / tick\].
    pub velocity: Vector3<f64>,
    /// Angular velocity, in the structure's frame \[rad / tick\].
    pub spin: Vector3<f64>,
}

impl BodyState {
    /// Returns a block at rest, aligned with the structure.
    pub fn at_rest(position: Vector3<f64>) -> BodyState {
        BodyState {
            position,
            orientation: UnitQuaternion::identity(),
            velocity: Vector3::zeros(),
            spin: Vector3::zeros(),
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    pub position: Vector3<f64>,
    pub rotation: UnitQuaternion<f64>,
}

impl Pose {
    /// Returns the pose after a rigid motion that takes another block from `from` to `to`.
    pub fn carried(&self, from: &Pose, to: &Pose) -> Pose {
        let turn = to.rotation * from.rotation.inverse();
        Pose {
            position: to.position + turn * (self.position - from.position),
            rotation: turn * self.rotation,
        }
    }
}

/// Motion of a block in block units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Motion {
    pub position: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub spin: Vector3<f64>,
}

/// All blocks by number, in the precision of the computation.
pub(crate) trait Blocks {
    type Real: Real;

    fn count(&self) -> u32;
    /// Returns the orientation of an anchored block, or `None` if it is free.
    fn anchored(&self, id: u32) -> Option<Orientation>;
    fn position(&self, id: u32) -> Vector3<Self::Real>;
    /// Returns the position, including the part that rounding removed from [`Blocks::position`].
    fn exact_position(&self, id: u32) -> Vector3<f64> {
        cast(self.position(id))
    }
    fn velocity(&self, id: u32) -> Vector3<Self::Real>;
    fn spin(&self, id: u32) -> Vector3<Self::Real>;
    /// Updates the rotation to the current step and returns it.
    fn rotation(&mut self, id: u32) -> UnitQuaternion<Self::Real>;
    /// Returns the current state without updating stored rotations.
    fn state(&self, id: u32) -> BodyState;

    fn set_state(&mut self, id: u32, state: &BodyState);
    fn set_pose(&mut self, id: u32, pose: &Pose);
    fn set_velocity(&mut self, id: u32, velocity: Vector3<Self::Real>, spin: Vector3<Self::Real>);
    /// Fixes a block to the lattice.
    fn anchor(&mut self, id: u32, centre: Vector3<Self::Real>, orientation: Orientation);
    /// Releases an anchored block, which is then at rest.
    fn release(&mut self, id: u32);

    fn is_free(&self, id: u32) -> bool {
        self.anchored(id).is_none()
    }

    /// Lists the free blocks in ascending order.
    fn list_free(&self, free: &mut Vec<u32>) {
        free.clear();
        free.extend((0..self.count()).filter(|&id| self.is_free(id)));
    }

    fn pose(&mut self, id: u32) -> Pose {
        let rotation = self.rotation(id).coords.map(Real::double);
        Pose {
            position: self.exact_position(id),
            rotation: UnitQuaternion::from_quaternion(rotation.into()),
        }
    }

    fn motion(&self, id: u32) -> Motion {
        Motion {
            position: self.exact_position(id),
            velocity: cast(self.velocity(id)),
            spin: cast(self.spin(id)),
        }
    }

    fn set_motion(&mut self, id: u32, velocity: Vector3<f64>, spin: Vector3<f64>) {
        self.set_velocity(id, cast(velocity), cast(spin));
    }
}
