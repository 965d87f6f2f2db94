//! Overlap of two convex bodies: direction of least overlap, and contact points.
mod box_box;
mod clipping;
mod cuboid;
mod ground;
mod separating_axis;
mod squares;

use nalgebra::Vector3;
use smallvec::SmallVec;

use crate::world::real::Real;

pub(super) use box_box::boxes;
pub(super) use cuboid::Cuboid;
pub(super) use ground::{ball_on_ground, cube_on_ground, face_on_ground};
pub(super) use squares::squares;

#[derive(Clone, Debug)]
pub(super) struct Manifold<R: Real> {
    /// Direction of the first body's shortest path out of the second body.
    pub normal: Vector3<R>,
    /// Points in order around the patch, unless several faces of a body touch.
    pub points: SmallVec<[ManifoldPoint<R>; 8]>,
    /// Gradient of the depth across the normal. 0 if the bodies touch at a single point.
    pub slope: Vector3<R>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct ManifoldPoint<R: Real> {
    /// Position in the middle of the overlap.
    pub position: Vector3<R>,
    /// Depth of the overlap, positive \[block lengths\].
    pub depth: R,
}

/// Returns the contact between the inscribed spheres of two cubes.
pub(super) fn balls<R: Real>(a: Vector3<R>, b: Vector3<R>) -> Option<Manifold<R>> {
    let offset = a - b;
    let distance = offset.norm();
    let depth = R::one() - distance;
    if depth <= R::zero() {
        return None;
    }
    let normal = if distance > R::zero() {
        offset / distance
    } else {
        Vector3::z()
    };
    let position = b + offset * R::from_double(0.5);
    Some(Manifold {
        normal,
        points: smallvec::smallvec![ManifoldPoint { position, depth }],
        slope: Vector3::zeros(),
    })
}
