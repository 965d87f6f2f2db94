//! Numbers side by side, in either precision: eight of different blocks, or a vector.
use std::ops::{Add, AddAssign, BitAnd, Div, Mul, MulAssign, Sub, SubAssign};

use nalgebra::Vector3;
use wide::{f32x4, f32x8, f64x4, f64x8};

use crate::world::real::Real;

/// How many numbers are computed side by side.
pub(super) const LANES: usize = 8;

/// The same where they have to be looked up one by one, and some lanes stay empty.
pub(super) const ABREAST: usize = 4;

/// A number that is computed with side by side.
pub(crate) trait Lane: Real {
    /// Eight of it.
    type Wide: Wide<Self, LANES>;
    /// Four of it, or a vector in space and a zero.
    type Quad: Quad<Self>;
}

/// `N` numbers.
///
/// What is greater than something is told by a mask: a pattern of bits in the place of a number.
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
    /// From memory.
    fn load(lanes: &[R; N]) -> Self;
    /// To memory.
    fn store(self) -> [R; N];
    /// The same number everywhere.
    fn splat(value: R) -> Self;
    /// Square roots.
    fn sqrt(self) -> Self;
    /// The greater ones, where both are numbers.
    fn maximum(self, other: Self) -> Self;
    /// The lesser ones, where both are numbers.
    fn minimum(self, other: Self) -> Self;
    /// Without their signs.
    fn abs(self) -> Self;
    /// Where it is greater than the other, as a mask; what is not a number is not.
    fn above(self, other: Self) -> Self;
    /// By a mask: the first number where it says so, and the second one elsewhere.
    fn choose(self, yes: Self, no: Self) -> Self;
    /// A mask with a bit for each number.
    fn bits(self) -> u32;
}

/// A vector in space whose components are computed side by side.
pub(crate) trait Quad<R>: Wide<R, ABREAST> + Default {
    /// The same vector.
    fn pack(vector: Vector3<R>) -> Self;
    /// The same vector.
    fn unpack(self) -> Vector3<R>;
    /// Every component multiplied by the same number.
    fn scaled(self, by: R) -> Self;
    /// The sum of the components.
    fn sum(self) -> R;
}

/// Of vectors, each in its lane.
#[inline(always)]
pub(super) fn cross<W: Copy + Mul<Output = W> + Sub<Output = W>>(a: [W; 3], b: [W; 3]) -> [W; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Of the components.
#[inline(always)]
pub(super) fn sum<W: Add<Output = W>>([x, y, z]: [W; 3]) -> W {
    x + y + z
}

/// Of vectors, each in its lane: their lengths squared.
#[inline(always)]
pub(super) fn square<W: Copy + Add<Output = W> + Mul<Output = W>>(vector: [W; 3]) -> W {
    sum(vector.map(|part| part * part))
}

/// Vectors, each in its lane.
#[inline(always)]
pub(super) fn transposed<R: Lane, const K: usize>(vectors: [[R; K]; ABREAST]) -> [R::Quad; K] {
    let [a, b, c, d] = vectors;
    std::array::from_fn(|axis| R::Quad::load(&[a[axis], b[axis], c[axis], d[axis]]))
}

/// At most [`ABREAST`] of something and at least one, the last of them again in the lanes that are left.
#[inline(always)]
pub(super) fn filled<T: Copy>(some: &[T]) -> [T; ABREAST] {
    let last = some.len() - 1;
    [0, 1, 2, 3].map(|lane: usize| some[lane.min(last)])
}

/// So many lanes from the first on, as a mask.
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
    // What only has another name there.
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
