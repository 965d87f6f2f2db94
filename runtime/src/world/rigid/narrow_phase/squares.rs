//! Contact points between two blocks of a planar world: upright boxes at the same height, seen from
//! above.
use smallvec::SmallVec;

use super::clipping::slope;
use super::cuboid::Cuboid;
use super::{Manifold, ManifoldPoint};
use crate::world::real::Real;

/// Returns the contact of two upright boxes at the same height, at this height. Nothing is computed
/// along the vertical.
pub fn squares<R: Real>(a: &Cuboid<'_, R>, b: &Cuboid<'_, R>) -> Option<Manifold<R>> {
    let offset = b.centre - a.centre;
    let mut least = R::from_double(f64::from(f32::MAX));
    let mut found = (true, 0);
    for is_first in [true, false] {
        let (own, other) = if is_first { (a, b) } else { (b, a) };
        for axis in 0..2 {
            let along = own.axis(axis);
            let reach = |i: usize| along.dot(&other.axis(i)).abs() * other.half[i];
            let depth = own.half[axis] + reach(0) + reach(1) - along.dot(&offset).abs();
            let overlaps = depth > R::zero();
            // Also rejects NaN.
            if !overlaps {
                return None;
            }
            if depth < least {
                (least, found) = (depth, (is_first, axis));
            }
        }
    }
    let (is_first, axis) = found;
    let (own, other, towards) = if is_first {
        (a, b, offset)
    } else {
        (b, a, -offset)
    };
    let sign = |value: R| {
        if value < R::zero() {
            -R::one()
        } else {
            R::one()
        }
    };
    let out = own.axis(axis) * sign(own.axis(axis).dot(&towards));
    let across = own.axis(1 - axis);
    // The side of the other square that is most opposite to `out`.
    let against = [0, 1].map(|i| other.axis(i).dot(&out));
    let side = usize::from(against[1].abs() > against[0].abs());
    let face = other.axis(side) * -sign(against[side]);
    let middle = other.centre + face * other.half[side];
    let along = other.axis(1 - side) * other.half[1 - side];
    // Its part in front of the own side, in half edges from `middle`.
    let half = own.half[1 - axis];
    let start = across.dot(&(middle - own.centre));
    let step = across.dot(&along);
    let ends = [-half, half].map(|limit| (limit - start) / step);
    let from = ends[0].min(ends[1]).max(-R::one());
    let to = ends[0].max(ends[1]).min(R::one());
    let depth_at = |position| own.half[axis] - out.dot(&(position - own.centre));
    let mut points = SmallVec::new();
    if from <= to {
        for end in [from, to] {
            let position = middle + along * end;
            let depth = depth_at(position);
            if depth > R::zero() {
                let position = position + out * (depth * R::from_double(0.5));
                points.push(ManifoldPoint { position, depth });
            }
        }
    }
    if points.is_empty() {
        // A corner of the own square is beyond the end of the side.
        let corner = across * (half * sign(start));
        let position = own.centre + out * (own.half[axis] - least * R::from_double(0.5)) + corner;
        points.push(ManifoldPoint {
            position,
            depth: least,
        });
    }
    let slope = if points.len() == 1 {
        nalgebra::Vector3::zeros()
    } else {
        slope(face, out)
    };
    Some(Manifold {
        normal: if is_first { -out } else { out },
        points,
        slope,
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::{Rotation3, Vector3};
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::world::rigid::narrow_phase::boxes;

    /// Compares the depth and the normal with the contact of cubes at the same height.
    #[test]
    fn squares_touch_like_cubes_at_the_same_height() {
        let mut dice = ChaCha8Rng::seed_from_u64(3);
        let mut touching = 0;
        for _ in 0..20_000 {
            let mut any = |size: f64| dice.random_range(-size..size);
            let turns =
                [any(3.2), any(3.2)].map(|yaw| Rotation3::from_scaled_axis(Vector3::z() * yaw));
            let (x, y) = (any(1.4), any(1.4));
            let a = Cuboid::<f64>::cube(Vector3::new(2.0, -1.0, 0.5), &turns[0]);
            let b = Cuboid::cube(a.centre + Vector3::new(x, y, 0.0), &turns[1]);
            let mut expected = None;
            boxes(&[(a, b); 4], 1, |_, manifold| {
                expected = Some(manifold.clone())
            });
            let found = squares(&a, &b);
            assert!(found.is_some() || expected.is_none(), "{a:?} {b:?}");
            let Some(found) = found else {
                continue;
            };
            // Only squares also report a corner beyond the end of the other side.
            let Some(expected) = expected else {
                assert_eq!(found.points.len(), 1, "{found:?}");
                continue;
            };
            touching += 1;
            // Deep overlaps have several directions of nearly the same depth.
            let deepest =
                |of: &Manifold<f64>| of.points.iter().fold(0.0, |d: f64, p| d.max(p.depth));
            if deepest(&expected) > 0.3 {
                continue;
            }
            assert!(
                (deepest(&found) - deepest(&expected)).abs() < 2e-3,
                "{found:?} {expected:?}"
            );
            for point in &found.points {
                assert_eq!(point.position.z, 0.5);
                assert!(point.depth > 0.0);
            }
            let angle = found.normal.angle(&expected.normal);
            assert!(angle < 1e-3, "{found:?} {expected:?}");
            assert_eq!(found.normal.z, 0.0);
        }
        assert!(touching > 5_000, "{touching}");
    }
}
