//! Where on a patch the force of a compliant contact acts.
//!
//! The energy of a contact is k d² / 2 with d its greatest depth, so that the force acts at the deepest point. On a
//! patch that is nearly level that point jumps from corner to corner when the patch rocks by next to nothing: it does
//! so many times in a step. What the force does on average is to keep the patch level as long as a point within
//! it can: it acts at the x for which d(x) - r (x - x0)² / 2 is greatest. With g the slope of the depth and r
//! the slope that the force makes per length in a step, that is the point of the patch nearest to x0 + g / r.
use nalgebra::Vector3;

use crate::world::real::Real;
use crate::world::rigid::narrow_phase::{Manifold, ManifoldPoint};
use crate::world::unit_cube::INVERSE_INERTIA;

/// The one point that stands for a patch.
///
/// `centres`: of the bodies that move. `response`: what a unit of depth changes the velocity of a block by in a step, times
/// the step.
pub(super) fn centre_of_pressure<R: Real>(
    manifold: &Manifold<R>,
    centres: [Option<Vector3<R>>; 2],
    response: R,
) -> ManifoldPoint<R> {
    let points = manifold.points.as_slice();
    let deepest = points.iter().fold(points[0], |deepest, point| {
        if point.depth > deepest.depth {
            *point
        } else {
            deepest
        }
    });
    let (mut middle, mut moving) = (Vector3::zeros(), R::zero());
    for centre in centres.into_iter().flatten() {
        middle += centre;
        moving += R::one();
    }
    if points.len() == 1 || moving == R::zero() {
        return deepest;
    }
    let middle = middle / moving;
    let levelling = moving * R::of(INVERSE_INERTIA) * response * deepest.depth;
    let normal = manifold.normal;
    let flat = |way: Vector3<R>| way - normal * normal.dot(&way);
    let wanted = flat(middle) + manifold.slope / levelling;
    // Within the patch, if it is on the same side of all of its edges.
    let nexts = points[1..].iter().chain(&points[..1]);
    let edges = || (points.iter().zip(nexts.clone())).map(|(from, to)| (from.place, to.place));
    let (mut left, mut right) = (points.len() > 2, points.len() > 2);
    for (from, to) in edges() {
        if !left && !right {
            break;
        }
        let side = normal.dot(&flat(to - from).cross(&(wanted - flat(from))));
        (left, right) = (left && side >= R::zero(), right && side <= R::zero());
    }
    let place = if left || right {
        let height = points
            .iter()
            .fold(R::zero(), |sum, point| sum + normal.dot(&point.place));
        wanted + normal * (height / R::of(points.len() as f64))
    } else {
        let mut best = (deepest.place, None);
        for (from, to) in edges() {
            let (start, along) = (flat(from), flat(to - from));
            let length = along.norm_squared();
            let part = if length > R::zero() {
                ((wanted - start).dot(&along) / length).clamp(R::zero(), R::one())
            } else {
                R::zero()
            };
            let away = (start + along * part - wanted).norm_squared();
            if best.1.is_none_or(|least| away < least) {
                best = (from + (to - from) * part, Some(away));
            }
        }
        best.0
    };
    let depth = deepest.depth + manifold.slope.dot(&(place - deepest.place));
    ManifoldPoint { place, depth }
}
