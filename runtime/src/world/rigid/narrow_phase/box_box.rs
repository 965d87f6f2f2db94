//! Contact points between two boxes.
use nalgebra::Vector3;
use smallvec::smallvec;

use super::clipping::face_points;
use super::cuboid::Cuboid;
use super::separating_axis::{Direction, LeastOverlap, least_overlaps};
use super::{Manifold, ManifoldPoint};
use crate::world::real::Real;
use crate::world::rigid::simd::{ABREAST, Lane};

/// Calls `touch` with the index and manifold of each overlapping pair among the first `count`.
/// Normals point from the second box to the first.
pub fn boxes<'a, R: Lane>(
    pairs: &[(Cuboid<'a, R>, Cuboid<'a, R>); ABREAST],
    count: usize,
    mut touch: impl FnMut(usize, &Manifold<R>),
) {
    for (number, overlap) in least_overlaps(pairs, count).iter().enumerate() {
        let (a, b) = &pairs[number];
        if let Some(overlap) = overlap
            && let Some(manifold) = manifold(a, b, overlap)
        {
            touch(number, &manifold);
        }
    }
}

/// Returns the contact points of two boxes along the direction of their least overlap.
fn manifold<R: Lane>(
    a: &Cuboid<'_, R>,
    b: &Cuboid<'_, R>,
    least: &LeastOverlap<R>,
) -> Option<Manifold<R>> {
    let offset = b.centre - a.centre;
    match least.direction {
        Direction::Face { first: true, axis } => {
            let out = outward(a.axis(axis), offset);
            face_points(a, b, out, axis).map(|(points, slope)| Manifold {
                normal: -out,
                points,
                slope,
            })
        }
        Direction::Face { first: false, axis } => {
            let out = outward(b.axis(axis), -offset);
            face_points(b, a, out, axis).map(|(points, slope)| Manifold {
                normal: out,
                points,
                slope,
            })
        }
        Direction::Edges { own, other } => {
            let across = a.axis(own).cross(&b.axis(other));
            let out = outward(across / across.norm(), offset);
            let position = between(a, own, b, other, out);
            Some(Manifold {
                normal: -out,
                points: smallvec![ManifoldPoint {
                    position,
                    depth: least.depth,
                }],
                slope: Vector3::zeros(),
            })
        }
    }
}

/// Returns `axis` or its opposite, whichever points along `towards`.
fn outward<R: Real>(axis: Vector3<R>, towards: Vector3<R>) -> Vector3<R> {
    if axis.dot(&towards) < R::zero() {
        -axis
    } else {
        axis
    }
}

/// Returns the midpoint between two edges: the edge of `a` farthest along `out`, and the edge of
/// `b` farthest in the opposite direction.
fn between<R: Real>(
    a: &Cuboid<'_, R>,
    own: usize,
    b: &Cuboid<'_, R>,
    other: usize,
    out: Vector3<R>,
) -> Vector3<R> {
    let middle = |of: &Cuboid<'_, R>, edge: usize, towards: Vector3<R>| {
        (1..3).fold(of.centre, |middle, step| {
            let axis = (edge + step) % 3;
            middle + outward(of.axis(axis), towards) * of.half[axis]
        })
    };
    let (from, to) = (middle(a, own, out), middle(b, other, -out));
    let (u, v) = (a.axis(own), b.axis(other));
    // Closest points of two lines that are not parallel.
    let displacement = to - from;
    let (uv, uw, vw) = (u.dot(&v), u.dot(&displacement), v.dot(&displacement));
    let rest = R::one() - uv * uv;
    let on_a = from + u * ((uw - uv * vw) / rest);
    let on_b = to + v * ((uv * uw - vw) / rest);
    (on_a + on_b) * R::from_double(0.5)
}
