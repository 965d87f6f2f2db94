//! Clipping of a face to the part inside another box.
//!
//! # Source
//!
//! I. E. Sutherland and G. W. Hodgman (1974).
use nalgebra::Vector3;
use smallvec::SmallVec;

use super::ManifoldPoint;
use super::cuboid::Cuboid;
use crate::world::real::Real;

/// Points of a contact patch, and the gradient of their depth.
type Patch<R> = (SmallVec<[ManifoldPoint<R>; 8]>, Vector3<R>);

pub type Polygon<R> = SmallVec<[Vector3<R>; 8]>;

/// Returns the points of a face of `other` that are below a face of `own`. Also returns the
/// gradient of their depth.
///
/// The face of `other` is the one most opposite to `out`. `out` is the outward normal of the face
/// of `own`, parallel to the axis with index `axis`.
pub fn face_points<R: Real>(
    own: &Cuboid<'_, R>,
    other: &Cuboid<'_, R>,
    out: Vector3<R>,
    axis: usize,
) -> Option<Patch<R>> {
    let (mut polygon, opposite) = opposite_face(other, out);
    for step in 1..3 {
        let side = (axis + step) % 3;
        let along = own.axis(side);
        let middle = along.dot(&own.centre);
        clip(&mut polygon, along, middle + own.half[side]);
        clip(&mut polygon, -along, own.half[side] - middle);
    }
    let level = out.dot(&own.centre) + own.half[axis];
    let points: SmallVec<_> = polygon
        .iter()
        .filter_map(|&corner| {
            let depth = level - out.dot(&corner);
            (depth > R::zero()).then(|| ManifoldPoint {
                position: corner + out * (depth * R::from_double(0.5)),
                depth,
            })
        })
        .collect();
    (!points.is_empty()).then(|| (points, slope(opposite, out)))
}

/// Returns the gradient of the depth of one face below another. The normals are `face` and `out`.
pub fn slope<R: Real>(face: Vector3<R>, out: Vector3<R>) -> Vector3<R> {
    let against = face.dot(&out);
    face / against - out
}

/// Returns the corners, in order, and the normal of the face most opposite to `out`.
pub fn opposite_face<R: Real>(of: &Cuboid<'_, R>, out: Vector3<R>) -> (Polygon<R>, Vector3<R>) {
    let along = of.axes.inverse_transform_vector(&out);
    let axis = along.iamax();
    let sign = if along[axis] > R::zero() {
        -R::one()
    } else {
        R::one()
    };
    let (one, two) = ((axis + 1) % 3, (axis + 2) % 3);
    let face = of.axis(axis) * sign;
    let middle = of.centre + face * of.half[axis];
    let (u, v) = (of.axis(one) * of.half[one], of.axis(two) * of.half[two]);
    let corners = [
        middle + u + v,
        middle - u + v,
        middle - u - v,
        middle + u - v,
    ];
    (SmallVec::from_iter(corners), face)
}

/// Removes the part of a polygon beyond `limit` along a direction.
fn clip<R: Real>(polygon: &mut Polygon<R>, along: Vector3<R>, limit: R) {
    let is_within = |corner: &Vector3<R>| along.dot(corner) - limit <= R::zero();
    if polygon.iter().all(is_within) {
        return;
    }
    clip_at(polygon, along, limit);
}

/// Clips a polygon that is partly beyond the limit. This is the slow path of `clip`.
fn clip_at<R: Real>(polygon: &mut Polygon<R>, along: Vector3<R>, limit: R) {
    let Some(&last) = polygon.last() else {
        return;
    };
    let mut inside = Polygon::new();
    let (mut before, mut excess_before) = (last, along.dot(&last) - limit);
    for &corner in polygon.iter() {
        let excess = along.dot(&corner) - limit;
        if (excess > R::zero()) != (excess_before > R::zero()) {
            let share = excess_before / (excess_before - excess);
            inside.push(before + (corner - before) * share);
        }
        if excess <= R::zero() {
            inside.push(corner);
        }
        (before, excess_before) = (corner, excess);
    }
    *polygon = inside;
}
