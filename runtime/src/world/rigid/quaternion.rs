//! Turning: the same arithmetic for one block and for several side by side.
use std::ops::{Add, Mul, Sub};

use crate::world::real::Real;

/// What can be computed with: a number, or several.
pub(super) trait Arithmetic:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
}

impl<N: Copy + Add<Output = N> + Sub<Output = N> + Mul<Output = N>> Arithmetic for N {}

/// For quarters of squared angles below this, [`small`] is right.
pub(super) const SMALL: f64 = 0.04;

/// Of a quarter of a squared angle: the cosine of half of the angle, and the sine of that over the
/// angle itself.
#[inline(always)]
pub(super) fn small<N: Arithmetic>(s: N, of: impl Fn(f64) -> N) -> (N, N) {
    // Both series are cut where the next term is below 1e-10.
    let nest = |by: [f64; 4]| {
        let term = |sum, &by: &f64| of(1.0) - s * of(1.0 / by) * sum;
        by.iter().rev().fold(of(1.0), term)
    };
    let cos = nest([2.0, 12.0, 30.0, 56.0]);
    let sinc = nest([6.0, 20.0, 42.0, 72.0]);
    (cos, sinc * of(0.5))
}

/// The same for any angle.
pub(super) fn large<R: Real>(s: R) -> (R, R) {
    let half = s.double().sqrt();
    let (sin, cos) = libm::sincos(half);
    (R::of(cos), R::of(sin / half / 2.0))
}

/// A quaternion (x, y, z, w), turned by a rotation vector whose cosine and sine are these.
#[inline(always)]
pub(super) fn turned<N: Arithmetic>(
    [x, y, z, w]: [N; 4],
    angle: [N; 3],
    (cos, over): (N, N),
    of: impl Fn(f64) -> N,
) -> [N; 4] {
    let [a, b, c] = angle.map(|angle| angle * over);
    let turned = [
        cos * x + a * w + b * z - c * y,
        cos * y - a * z + b * w + c * x,
        cos * z + a * y - b * x + c * w,
        cos * w - a * x - b * y - c * z,
    ];
    let [i, j, k, l] = turned.map(|part| part * part);
    // It is so close to one that one step of Newton's for the root will do.
    let factor = (of(3.0) - ((i + k) + (j + l))) * of(0.5);
    turned.map(|part| part * factor)
}

/// The columns of the matrix of a unit quaternion.
#[inline(always)]
pub(super) fn columns<N: Arithmetic>([i, j, k, w]: [N; 4], of: impl Fn(f64) -> N) -> [[N; 3]; 3] {
    let (ww, ii, jj, kk) = (w * w, i * i, j * j, k * k);
    let (ij, wk, wj) = (i * j * of(2.0), w * k * of(2.0), w * j * of(2.0));
    let (ik, jk, wi) = (i * k * of(2.0), j * k * of(2.0), w * i * of(2.0));
    [
        [ww + ii - jj - kk, wk + ij, ik - wj],
        [ij - wk, ww - ii + jj - kk, wi + jk],
        [wj + ik, jk - wi, ww - ii - jj + kk],
    ]
}
