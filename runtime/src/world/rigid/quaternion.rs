//! Rotation by quaternions: the same arithmetic for one block and for SIMD lanes.
use std::ops::{Add, Mul, Sub};

use crate::world::real::Real;

/// Scalar or vector of scalars.
pub(super) trait Arithmetic:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
}

impl<N: Copy + Add<Output = N> + Sub<Output = N> + Mul<Output = N>> Arithmetic for N {}

/// Quarter of the squared angle below which [`small`] is accurate.
pub(super) const SMALL: f64 = 0.04;

/// Returns the cosine of half an angle, and the sine of half the angle divided by the angle. `s` is
/// a quarter of the squared angle.
#[inline(always)]
pub(super) fn small<N: Arithmetic>(s: N, of: impl Fn(f64) -> N) -> (N, N) {
    // Both series end at the first term below 1e-10.
    let nest = |by: [f64; 4]| {
        let term = |sum, &by: &f64| of(1.0) - s * of(1.0 / by) * sum;
        by.iter().rev().fold(of(1.0), term)
    };
    let cos = nest([2.0, 12.0, 30.0, 56.0]);
    let sinc = nest([6.0, 20.0, 42.0, 72.0]);
    (cos, sinc * of(0.5))
}

/// Returns the same values as [`small`], for any angle.
pub(super) fn large<R: Real>(s: R) -> (R, R) {
    let half = s.double().sqrt();
    let (sin, cos) = libm::sincos(half);
    (R::from_double(cos), R::from_double(sin / half / 2.0))
}

/// Rotates a quaternion (x, y, z, w) by a rotation vector. `cos` and `over` are the results of
/// [`small`].
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
    // The norm is close to one, so one Newton step of the root suffices.
    let factor = (of(3.0) - ((i + k) + (j + l))) * of(0.5);
    turned.map(|part| part * factor)
}

/// Returns the columns of the matrix of a unit quaternion.
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
