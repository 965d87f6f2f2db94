//! Box with any orientation.
use nalgebra::{Rotation3, Vector3};

use crate::world::real::Real;

/// A box with its position and orientation.
#[derive(Clone, Copy, Debug)]
pub struct Cuboid<'a, R: Real> {
    pub centre: Vector3<R>,
    /// Rotation from the box's axes to the world's.
    pub axes: &'a Rotation3<R>,
    /// Half of the edge lengths.
    pub half: Vector3<R>,
}

impl<R: Real> Cuboid<'_, R> {
    pub fn cube(centre: Vector3<R>, axes: &Rotation3<R>) -> Cuboid<'_, R> {
        Cuboid {
            centre,
            axes,
            half: Vector3::repeat(R::from_double(0.5)),
        }
    }

    pub fn axis(&self, i: usize) -> Vector3<R> {
        self.axes.matrix().column(i).into_owned()
    }
}
