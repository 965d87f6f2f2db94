//! Two boxes: the fifteen separating axes (Gottschalk, Lin, Manocha 1996).
use nalgebra::{Rotation3, Vector3};
use smallvec::smallvec;

use super::clip::face_points;
use super::{Patch, Point};
use crate::world::real::Real;

/// Edges count as parallel when the sine of their angle is below this.
const PARALLEL: f64 = 1e-3;

/// A face is preferred to an edge that is not shallower by more than this \[side\]: several points
/// hold better than one.
const PREFER_FACE: f64 = 1e-3;

/// A box in space.
#[derive(Clone, Copy, Debug)]
pub struct Cuboid<R: Real> {
    pub centre: Vector3<R>,
    /// Own directions to the world's.
    pub axes: Rotation3<R>,
    /// Half of its edges.
    pub half: Vector3<R>,
}

/// The direction in which two boxes overlap least.
enum Least {
    /// Normal to a face of the first or second box.
    Face { first: bool, axis: usize },
    /// Normal to an edge of each.
    Edges { own: usize, other: usize },
}

impl<R: Real> Cuboid<R> {
    /// A block.
    pub fn cube(centre: Vector3<R>, axes: Rotation3<R>) -> Cuboid<R> {
        Cuboid {
            centre,
            axes,
            half: Vector3::repeat(R::of(0.5)),
        }
    }

    pub fn axis(&self, i: usize) -> Vector3<R> {
        self.axes.matrix().column(i).into_owned()
    }
}

/// How two boxes overlap; `None`: they do not. The normal points from `b` to `a`.
pub fn boxes<R: Real>(a: &Cuboid<R>, b: &Cuboid<R>) -> Option<Patch<R>> {
    let offset = b.centre - a.centre;
    let in_a = a.axes.inverse_transform_vector(&offset);
    let turn = a.axes.matrix().tr_mul(b.axes.matrix());
    let size = turn.abs();
    let mut least = Least::Face {
        first: true,
        axis: 0,
    };
    let mut depth = R::of(f64::from(f32::MAX));
    for axis in 0..3 {
        let reach = a.half[axis] + size.row(axis).transpose().dot(&b.half);
        let overlap = reach - in_a[axis].abs();
        if overlap <= R::zero() {
            return None;
        }
        if overlap < depth {
            depth = overlap;
            least = Least::Face { first: true, axis };
        }
    }
    let in_b = turn.tr_mul(&in_a);
    for axis in 0..3 {
        let reach = b.half[axis] + size.column(axis).dot(&a.half);
        let overlap = reach - in_b[axis].abs();
        if overlap <= R::zero() {
            return None;
        }
        if overlap < depth {
            depth = overlap;
            least = Least::Face { first: false, axis };
        }
    }
    let face = depth;
    for own in 0..3 {
        let (own1, own2) = ((own + 1) % 3, (own + 2) % 3);
        for other in 0..3 {
            let (other1, other2) = ((other + 1) % 3, (other + 2) % 3);
            // The cross product of the two edges, in the frame of `a`.
            let square = R::one() - turn[(own, other)] * turn[(own, other)];
            if square < R::of(PARALLEL * PARALLEL) {
                continue;
            }
            let reach = a.half[own1] * size[(own2, other)]
                + a.half[own2] * size[(own1, other)]
                + b.half[other1] * size[(own, other2)]
                + b.half[other2] * size[(own, other1)];
            let apart = in_a[own2] * turn[(own1, other)] - in_a[own1] * turn[(own2, other)];
            let overlap = reach - apart.abs();
            if overlap <= R::zero() {
                return None;
            }
            let overlap = overlap / square.sqrt();
            if overlap < depth && overlap < face - R::of(PREFER_FACE) {
                depth = overlap;
                least = Least::Edges { own, other };
            }
        }
    }
    match least {
        Least::Face { first: true, axis } => {
            let out = outward(a.axis(axis), offset);
            face_points(a, b, out, axis).map(|points| Patch {
                normal: -out,
                points,
            })
        }
        Least::Face { first: false, axis } => {
            let out = outward(b.axis(axis), -offset);
            face_points(b, a, out, axis).map(|points| Patch {
                normal: out,
                points,
            })
        }
        Least::Edges { own, other } => {
            let across = a.axis(own).cross(&b.axis(other));
            let out = outward(across / across.norm(), offset);
            let place = between(a, own, b, other, out);
            Some(Patch {
                normal: -out,
                points: smallvec![Point { place, depth }],
            })
        }
    }
}

/// `axis` or its opposite, whichever points along `towards`.
fn outward<R: Real>(axis: Vector3<R>, towards: Vector3<R>) -> Vector3<R> {
    if axis.dot(&towards) < R::zero() {
        -axis
    } else {
        axis
    }
}

/// Halfway between the edge of `a` that is farthest along `out` and the edge of `b` farthest back.
fn between<R: Real>(
    a: &Cuboid<R>,
    own: usize,
    b: &Cuboid<R>,
    other: usize,
    out: Vector3<R>,
) -> Vector3<R> {
    let middle = |of: &Cuboid<R>, edge: usize, towards: Vector3<R>| {
        (1..3).fold(of.centre, |middle, step| {
            let axis = (edge + step) % 3;
            middle + outward(of.axis(axis), towards) * of.half[axis]
        })
    };
    let (from, to) = (middle(a, own, out), middle(b, other, -out));
    let (u, v) = (a.axis(own), b.axis(other));
    // The closest points of two lines that are not parallel.
    let way = to - from;
    let (uv, uw, vw) = (u.dot(&v), u.dot(&way), v.dot(&way));
    let rest = R::one() - uv * uv;
    let on_a = from + u * ((uw - uv * vw) / rest);
    let on_b = to + v * ((uv * uw - vw) / rest);
    (on_a + on_b) * R::of(0.5)
}
