//! SIMD vectors in either precision: eight numbers of different blocks, or a vector in space.
use std::ops::{Add, AddAssign, BitAnd, Div, Mul, MulAssign, Sub, SubAssign};

use nalgebra::Vector3;
use wide::{f32x4, f32x8, f64x4, f64x8};

use crate::world::real::Real;

/// Number of lanes of vectors for sequential data.
pub(super) const LANES: usize = 8;

/// Number of lanes of vectors for gathered data. Some lanes may be unused.
pub(super) const ABREAST: usize = 4;

/// Scalar type that has SIMD vectors.
pub(crate) trait Lane: Real {
    /// Vector of [`LANES`] numbers.
    type Wide: Wide<Self, LANES>;
    /// Vector of four numbers, or a vector in space and a zero.
    type Quad: Quad<Self>;
}

/// Vector of `N` numbers.
///
/// Comparisons return masks: bit patterns in place of numbers.
pub(crate) trait Wide<R, const N: usize>:
    Copy
    + std::fmt::Debug
    + BitAnd<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    fn load(lanes: &[R; N]) -> Self;
    fn store(self) -> [R; N];
    fn splat(value: R) -> Self;
    fn sqrt(self) -> Self;
    /// Returns the larger number in each lane if neither is NaN.
    fn maximum(self, other: Self) -> Self;
    /// Returns the smaller number in each lane if neither is NaN.
    fn minimum(self, other: Self) -> Self;
    fn abs(self) -> Self;
    /// Returns a mask of the lanes that are greater than in `other`. NaN is not greater than any
    /// number.
    fn above(self, other: Self) -> Self;
    /// Selects `yes` in the lanes of the mask and `no` elsewhere.
    fn choose(self, yes: Self, no: Self) -> Self;
    /// Returns the mask as one bit per lane.
    fn bits(self) -> u32;
}

/// Vector in space as one SIMD vector.
pub(crate) trait Quad<R>: Wide<R, ABREAST> + Default {
    fn pack(vector: Vector3<R>) -> Self;
    fn unpack(self) -> Vector3<R>;
    fn scaled(self, by: R) -> Self;
    fn sum(self) -> R;
}

/// Returns the cross product of two vectors. Each component may be a SIMD vector.
#[inline(always)]
pub(super) fn cross<W: Copy + Mul<Output = W> + Sub<Output = W>>(a: [W; 3], b: [W; 3]) -> [W; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[inline(always)]
pub(super) fn sum<W: Add<Output = W>>([x, y, z]: [W; 3]) -> W {
    x + y + z
}

/// Returns the squared length of a vector. Each component may be a SIMD vector.
#[inline(always)]
pub(super) fn square<W: Copy + Add<Output = W> + Mul<Output = W>>(vector: [W; 3]) -> W {
    sum(vector.map(|part| part * part))
}

/// Transposes vectors: lane i of result k is component k of vector i.
#[inline(always)]
pub(super) fn transposed<R: Lane, const K: usize>(vectors: [[R; K]; ABREAST]) -> [R::Quad; K] {
    let [a, b, c, d] = vectors;
    std::array::from_fn(|axis| R::Quad::load(&[a[axis], b[axis], c[axis], d[axis]]))
}

/// Returns one to [`ABREAST`] elements, padded with copies of the last one.
#[inline(always)]
pub(super) fn filled<T: Copy>(some: &[T]) -> [T; ABREAST] {
    let last = some.len() - 1;
    [0, 1, 2, 3].map(|lane: usize| some[lane.min(last)])
}

/// Returns a mask of the first `count` lanes.
#[inline(always)]
pub(super) fn first<R: Lane>(count: usize) -> R::Quad {
    let lanes = std::array::from_fn(|lane| if lane < count { R::one() } else { R::zero() });
    R::Quad::load(&lanes).above(R::Quad::splat(R::zero()))
}

macro_rules! wide {
    ($real:ty, $wide:ty, $lanes:expr) => {
        impl Wide<$real, $lanes> for $wide {
            #[inline(always)]
            fn load(lanes: &[$real; $lanes]) -> $wide {
                <$wide>::new(*lanes)
            }
            #[inline(always)]
            fn store(self) -> [$real; $lanes] {
                self.to_array()
            }
            #[inline(always)]
            fn splat(value: $real) -> $wide {
                <$wide>::splat(value)
            }
            #[inline(always)]
            fn bits(self) -> u32 {
                self.to_bitmask()
            }
            wide!(@same $wide; sqrt() = sqrt, abs() = abs, maximum(other) = fast_max,
                minimum(other) = fast_min, above(other) = simd_gt, choose(yes, no) = select);
        }
    };
    // Operations with another name in the library.
    (@same $wide:ty; $($name:ident($($with:ident),*) = $theirs:ident),+) => {
        $(
            #[inline(always)]
            fn $name(self, $($with: $wide),*) -> $wide {
                <$wide>::$theirs(self, $($with),*)
            }
        )+
    };
}

macro_rules! lanes {
    ($real:ty, $wide:ty, $quad:ty) => {
        impl Lane for $real {
            type Wide = $wide;
            type Quad = $quad;
        }

        wide!($real, $wide, LANES);
        wide!($real, $quad, ABREAST);

        impl Quad<$real> for $quad {
            #[inline(always)]
            fn pack(v: Vector3<$real>) -> $quad {
                <$quad>::new([v.x, v.y, v.z, 0.0])
            }
            #[inline(always)]
            fn unpack(self) -> Vector3<$real> {
                let [x, y, z, _] = self.to_array();
                Vector3::new(x, y, z)
            }
            #[inline(always)]
            fn scaled(self, by: $real) -> $quad {
                self * <$quad>::splat(by)
            }
            #[inline(always)]
            fn sum(self) -> $real {
                let [x, y, z, _] = self.to_array();
                x + y + z
            }
        }
    };
}

lanes!(f32, f32x8, f32x4);
lanes!(f64, f64x8, f64x4);
