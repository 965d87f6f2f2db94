//! Elastic shell that encloses the blocks.
use nalgebra::Vector3;

use super::parameters::Wall;
use super::real::Real;

/// Elastic shell in the precision of a world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallForce<R> {
    pub radius: R,
    /// Height of the shell's centre.
    pub height: R,
    /// Acceleration per depth.
    pub stiffness: R,
}

impl<R: Real> WallForce<R> {
    pub fn new(wall: &Wall) -> WallForce<R> {
        WallForce {
            radius: R::from_double(wall.radius),
            height: R::from_double(wall.height),
            stiffness: R::from_double(wall.stiffness),
        }
    }

    /// Returns the acceleration that the shell gives a block at a position \[block lengths /
    /// tick^2\].
    pub fn push(&self, place: Vector3<R>) -> Vector3<R> {
        let pull = self.pull(place);
        pull.map_or_else(Vector3::zeros, |(way, pull)| way * -pull)
    }

    /// Returns the position relative to the shell's centre and the inward acceleration per distance
    /// \[1 / tick^2\]. Returns `None` if the block is inside the shell.
    pub fn pull(&self, place: Vector3<R>) -> Option<(Vector3<R>, R)> {
        let way = place - Vector3::z() * self.height;
        // Fast path without a square root: most blocks are far inside.
        if way.norm_squared() < R::from_double(0.99) * self.radius * self.radius {
            return None;
        }
        let distance = way.norm();
        let depth = distance - self.radius;
        (depth > R::zero()).then(|| (way, self.stiffness * depth / distance))
    }
}
