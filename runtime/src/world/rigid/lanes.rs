//! Eight numbers side by side, in either precision.
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Sub, SubAssign};

use wide::{f32x8, f64x8};

use crate::world::real::Real;

/// How many numbers are computed side by side.
pub(super) const LANES: usize = 8;

/// A number that comes in eights.
pub(crate) trait Lane: Real {
    /// Eight of it.
    type Wide: Wide<Self>;
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
    ($real:ty, $wide:ty) => {
        impl Lane for $real {
            type Wide = $wide;
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

lanes!(f32, f32x8);
lanes!(f64, f64x8);
