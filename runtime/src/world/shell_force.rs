//! The elastic shell that encloses the blocks.
use nalgebra::Vector3;

use super::parameters::Shell;
use super::real::Real;

/// The shell in the precision of a world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShellForce<R> {
    pub radius: R,
    /// Of its centre.
    pub height: R,
    /// Change of velocity per depth and time.
    pub stiffness: R,
}

impl<R: Real> ShellForce<R> {
    pub fn new(shell: &Shell) -> ShellForce<R> {
        ShellForce {
            radius: R::of(shell.radius),
            height: R::of(shell.height),
            stiffness: R::of(shell.stiffness),
        }
    }

    /// What the velocity of a block there changes by \[side / tick^2\].
    pub fn push(&self, place: Vector3<R>) -> Vector3<R> {
        let pull = self.pull(place);
        pull.map_or_else(Vector3::zeros, |(way, pull)| way * -pull)
    }

    /// Where a block there is, seen from the centre, and what its velocity changes by inward and for each side of that
    /// way \[1 / tick^2\]; `None`: it is within.
    pub fn pull(&self, place: Vector3<R>) -> Option<(Vector3<R>, R)> {
        let way = place - Vector3::z() * self.height;
        // Most are far within, and need no root.
        if way.norm_squared() < R::of(0.99) * self.radius * self.radius {
            return None;
        }
        let distance = way.norm();
        let depth = distance - self.radius;
        (depth > R::zero()).then(|| (way, self.stiffness * depth / distance))
    }
}
