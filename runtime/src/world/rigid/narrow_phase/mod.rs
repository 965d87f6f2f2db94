//! Where two convex bodies overlap: along which direction least, and at which points.
mod box_box;
mod clipping;
mod cuboid;
mod ground;
mod separating_axis;

use nalgebra::Vector3;
use smallvec::SmallVec;

use crate::world::real::Real;

pub(super) use box_box::boxes;
pub(super) use cuboid::Cuboid;
pub(super) use ground::{ball_on_ground, cube_on_ground, face_on_ground};

/// The points at which one body touches another.
#[derive(Clone, Debug)]
pub(super) struct Manifold<R: Real> {
    /// The direction in which the first body leaves the second one soonest.
    pub normal: Vector3<R>,
    /// In order around the patch, unless several faces of a body touch.
    pub points: SmallVec<[ManifoldPoint<R>; 8]>,
    /// How much deeper the bodies overlap per length across the normal; 0 if they touch in a point.
    pub slope: Vector3<R>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct ManifoldPoint<R: Real> {
    /// In the middle of the overlap.
    pub place: Vector3<R>,
    /// How far the bodies overlap there \[side\], more than 0.
    pub depth: R,
}

/// Two balls as large as a cube's faces let them be.
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
    let place = b + offset * R::of(0.5);
    Some(Manifold {
        normal,
        points: smallvec::smallvec![ManifoldPoint { place, depth }],
        slope: Vector3::zeros(),
    })
}
