//! Where the blocks of a world are and how they move, as forces, faces and bonds see them.
use nalgebra::{UnitQuaternion, Vector3};
use stochc_protocol::Orientation;

use super::real::{Real, cast};

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

/// How a block is placed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    pub position: Vector3<f64>,
    pub rotation: UnitQuaternion<f64>,
}

impl Pose {
    /// Where a block comes to that moves as one body with another one, which goes from here to there.
    pub fn carried(&self, from: &Pose, to: &Pose) -> Pose {
        let turn = to.rotation * from.rotation.inverse();
        Pose {
            position: to.position + turn * (self.position - from.position),
            rotation: turn * self.rotation,
        }
    }
}

/// How a block moves, in block units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Motion {
    pub position: Vector3<f64>,
    pub velocity: Vector3<f64>,
    pub spin: Vector3<f64>,
}

/// All blocks by number, in the precision that they are computed in.
pub(crate) trait Blocks {
    type Real: Real;

    fn count(&self) -> u32;
    /// How a block sits in the structure; `None`: it is free.
    fn anchored(&self, id: u32) -> Option<Orientation>;
    fn position(&self, id: u32) -> Vector3<Self::Real>;
    /// The same with what rounding has kept from it.
    fn exact_position(&self, id: u32) -> Vector3<f64> {
        cast(self.position(id))
    }
    fn velocity(&self, id: u32) -> Vector3<Self::Real>;
    fn spin(&self, id: u32) -> Vector3<Self::Real>;
    /// How a block is turned now; brings that up to date.
    fn rotation(&mut self, id: u32) -> UnitQuaternion<Self::Real>;
    /// The same as of now, without bringing anything up to date.
    fn state(&self, id: u32) -> BodyState;

    fn set_state(&mut self, id: u32, state: &BodyState);
    fn set_pose(&mut self, id: u32, pose: &Pose);
    fn set_velocity(&mut self, id: u32, velocity: Vector3<Self::Real>, spin: Vector3<Self::Real>);
    /// Fixes a block on the lattice.
    fn anchor(&mut self, id: u32, centre: Vector3<Self::Real>, orientation: Orientation);
    /// Sets an anchored block free, at rest.
    fn release(&mut self, id: u32);

    fn is_free(&self, id: u32) -> bool {
        self.anchored(id).is_none()
    }

    /// The free blocks, in rising order.
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
