//! Numbers side by side, in either precision: eight of different blocks, or a vector.
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Sub, SubAssign};

use nalgebra::Vector3;
use wide::{f32x4, f32x8, f64x4, f64x8};

use crate::world::real::Real;

/// How many numbers are computed side by side.
pub(super) const LANES: usize = 8;

/// A number that is computed with side by side.
pub(crate) trait Lane: Real {
    /// Eight of it.
    type Wide: Wide<Self>;
    /// A vector in space, and a zero.
    type Quad: Quad<Self>;
}

/// A vector in space whose components are computed side by side.
pub(crate) trait Quad<R>:
    Copy
    + Default
    + std::fmt::Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + AddAssign
    + SubAssign
{
    /// The same vector.
    fn pack(vector: Vector3<R>) -> Self;
    /// The same vector.
    fn unpack(self) -> Vector3<R>;
    /// Every component multiplied by the same number.
    fn scaled(self, by: R) -> Self;
    /// The sum of the components.
    fn sum(self) -> R;
}

/// Eight numbers.
pub(crate) trait Wide<R>:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// From memory.
    fn load(lanes: &[R; LANES]) -> Self;
    /// To memory.
    fn store(self) -> [R; LANES];
    /// The same number eight times.
    fn splat(value: R) -> Self;
    /// Square roots.
    fn sqrt(self) -> Self;
    /// The greater ones, where both are numbers.
    fn most(self, other: Self) -> Self;
}

macro_rules! lanes {
    ($real:ty, $wide:ty, $quad:ty) => {
        impl Lane for $real {
            type Wide = $wide;
            type Quad = $quad;
        }

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
                self.reduce_add()
            }
        }

        impl Wide<$real> for $wide {
            #[inline(always)]
            fn load(lanes: &[$real; LANES]) -> $wide {
                <$wide>::new(*lanes)
            }
            #[inline(always)]
            fn store(self) -> [$real; LANES] {
                self.to_array()
            }
            #[inline(always)]
            fn splat(value: $real) -> $wide {
                <$wide>::splat(value)
            }
            #[inline(always)]
            fn sqrt(self) -> $wide {
                self.sqrt()
            }
            #[inline(always)]
            fn most(self, other: $wide) -> $wide {
                self.fast_max(other)
            }
        }
    };
}

lanes!(f32, f32x8, f32x4);
lanes!(f64, f64x8, f64x4);
