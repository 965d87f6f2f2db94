//! Centre of pressure: the point of attack of a compliant contact's force within the contact patch.
//!
//! A contact has the energy k d² / 2, where d is its largest depth. Its force therefore acts at the
//! deepest point. On an almost level patch, that point jumps between corners many times per step.
//! On average, the force keeps the patch level if a point within the patch can. The force acts at
//! the x that maximizes d(x) - r (x - x0)² / 2. This is the point of the patch nearest to x0 + g /
//! r. Here g is the gradient of the depth. The force makes a gradient of r per length in a step.
use nalgebra::Vector3;

use crate::world::real::Real;
use crate::world::rigid::narrow_phase::{Manifold, ManifoldPoint};
use crate::world::unit_cube::INVERSE_INERTIA;

/// Returns the point that represents a contact patch.
///
/// `centres` are the centres of the moving bodies. `response` is the displacement of a block in a
/// step, per unit of depth.
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
    let levelling = moving * R::from_double(INVERSE_INERTIA) * response * deepest.depth;
    let normal = manifold.normal;
    let flat = |vector: Vector3<R>| vector - normal * normal.dot(&vector);
    let requested = flat(middle) + manifold.slope / levelling;
    // A point is within the patch if it is on the same side of all edges.
    let nexts = points[1..].iter().chain(&points[..1]);
    let edges =
        || (points.iter().zip(nexts.clone())).map(|(from, to)| (from.position, to.position));
    let (mut left, mut right) = (points.len() > 2, points.len() > 2);
    for (from, to) in edges() {
        if !left && !right {
            break;
        }
        let side = normal.dot(&flat(to - from).cross(&(requested - flat(from))));
        (left, right) = (left && side >= R::zero(), right && side <= R::zero());
    }
    let position = if left || right {
        let height = points
            .iter()
            .fold(R::zero(), |sum, point| sum + normal.dot(&point.position));
        requested + normal * (height / R::from_double(points.len() as f64))
    } else {
        let mut best = (deepest.position, None);
        for (from, to) in edges() {
            let (start, along) = (flat(from), flat(to - from));
            let length = along.norm_squared();
            let part = if length > R::zero() {
                ((requested - start).dot(&along) / length).clamp(R::zero(), R::one())
            } else {
                R::zero()
            };
            let away = (start + along * part - requested).norm_squared();
            if best.1.is_none_or(|least| away < least) {
                best = (from + (to - from) * part, Some(away));
            }
        }
        best.0
    };
    let depth = deepest.depth + manifold.slope.dot(&(position - deepest.position));
    ManifoldPoint { position, depth }
}
