//! Contacts with the plane z = 0.
use nalgebra::{Rotation3, Vector3};
use smallvec::{SmallVec, smallvec};

use super::clipping::{opposite_face, slope};
use super::cuboid::Cuboid;
use super::{Manifold, ManifoldPoint};
use crate::world::real::Real;

/// Returns the corners of a cube that are below the ground.
pub fn cube_on_ground<R: Real>(centre: Vector3<R>, axes: &Rotation3<R>) -> Option<Manifold<R>> {
    let half = R::from_double(0.5);
    let row = axes.matrix().row(2) * half;
    if centre.z >= row[0].abs() + row[1].abs() + row[2].abs() {
        return None;
    }
    let mut points = SmallVec::new();
    for corner in 0..8 {
        let above = |axis: usize| {
            if corner >> axis & 1 == 1 {
                row[axis]
            } else {
                -row[axis]
            }
        };
        if centre.z + above(0) + above(1) + above(2) < R::zero() {
            let side = |axis: usize| if corner >> axis & 1 == 1 { half } else { -half };
            let own = Vector3::new(side(0), side(1), side(2));
            points.push(raised(centre + axes * own));
        }
    }
    let normal = Vector3::z();
    let slope = Vector3::zeros();
    (!points.is_empty()).then_some(Manifold {
        normal,
        points,
        slope,
    })
}

/// Returns the corners of a cube's lowest face that are below the ground.
pub fn face_on_ground<R: Real>(centre: Vector3<R>, axes: &Rotation3<R>) -> Option<Manifold<R>> {
    let half = R::from_double(0.5);
    let row = axes.matrix().row(2) * half;
    if centre.z >= row[0].abs() + row[1].abs() + row[2].abs() {
        return None;
    }
    let (face, out) = opposite_face(&Cuboid::cube(centre, axes), Vector3::z());
    let below = face.iter().filter(|corner| corner.z < R::zero());
    let points: SmallVec<_> = below.map(|&corner| raised(corner)).collect();
    (!points.is_empty()).then_some(Manifold {
        normal: Vector3::z(),
        points,
        slope: slope(out, Vector3::z()),
    })
}

/// Returns the contact of a sphere of diameter 1 that reaches below the ground.
pub fn ball_on_ground<R: Real>(centre: Vector3<R>) -> Option<Manifold<R>> {
    let lowest = centre - Vector3::z() * R::from_double(0.5);
    (lowest.z < R::zero()).then(|| Manifold {
        normal: Vector3::z(),
        points: smallvec![raised(lowest)],
        slope: Vector3::zeros(),
    })
}

/// Returns a contact halfway between a position below the ground and the ground.
fn raised<R: Real>(position: Vector3<R>) -> ManifoldPoint<R> {
    ManifoldPoint {
        position: Vector3::new(position.x, position.y, position.z * R::from_double(0.5)),
        depth: -position.z,
    }
}
