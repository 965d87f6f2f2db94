//! The part of a face that lies inside of another box (Sutherland, Hodgman 1974).
use nalgebra::Vector3;
use smallvec::SmallVec;

use super::{Cuboid, ManifoldPoint};
use crate::world::real::Real;

type Polygon<R> = SmallVec<[Vector3<R>; 8]>;

/// The points of `other`'s most opposite face that are below the face of `own` that looks along
/// `out`, which is its direction number `axis` or the opposite.
pub fn face_points<R: Real>(
    own: &Cuboid<R>,
    other: &Cuboid<R>,
    out: Vector3<R>,
    axis: usize,
) -> Option<SmallVec<[ManifoldPoint<R>; 8]>> {
    let mut polygon = opposite_face(other, out);
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
                place: corner + out * (depth * R::of(0.5)),
                depth,
            })
        })
        .collect();
    (!points.is_empty()).then_some(points)
}

/// The corners of the face that looks most against `out`, in order.
fn opposite_face<R: Real>(of: &Cuboid<R>, out: Vector3<R>) -> Polygon<R> {
    let along = of.axes.inverse_transform_vector(&out);
    let axis = along.iamax();
    let sign = if along[axis] > R::zero() {
        -R::one()
    } else {
        R::one()
    };
    let (one, two) = ((axis + 1) % 3, (axis + 2) % 3);
    let middle = of.centre + of.axis(axis) * (sign * of.half[axis]);
    let (u, v) = (of.axis(one) * of.half[one], of.axis(two) * of.half[two]);
    SmallVec::from_iter([
        middle + u + v,
        middle - u + v,
        middle - u - v,
        middle + u - v,
    ])
}

/// Cuts off what is farther than `limit` along a direction.
fn clip<R: Real>(polygon: &mut Polygon<R>, along: Vector3<R>, limit: R) {
    let Some(&last) = polygon.last() else {
        return;
    };
    let mut kept = Polygon::new();
    let (mut before, mut excess_before) = (last, along.dot(&last) - limit);
    for &corner in polygon.iter() {
        let excess = along.dot(&corner) - limit;
        if (excess > R::zero()) != (excess_before > R::zero()) {
            let share = excess_before / (excess_before - excess);
            kept.push(before + (corner - before) * share);
        }
        if excess <= R::zero() {
            kept.push(corner);
        }
        (before, excess_before) = (corner, excess);
    }
    *polygon = kept;
}
