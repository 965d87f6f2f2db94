//! Single or double precision.
use nalgebra::{RealField, Vector3};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Floating-point type of a computation.
pub(crate) trait Real: RealField + Copy + Default + Serialize + DeserializeOwned {
    /// Returns the number nearest to `value`.
    fn from_double(value: f64) -> Self;
    /// Converts an integer: exactly in double precision, within 2^-24 in single precision.
    fn from_integer(value: i32) -> Self;
    fn double(self) -> f64;
    /// Rounds a number from 0 to 2^22 to the nearest integer. Uses one addition instead of a
    /// general conversion.
    fn round_small(self) -> u32;
}

impl Real for f32 {
    fn from_double(value: f64) -> f32 {
        value as f32
    }
    fn from_integer(value: i32) -> f32 {
        value as f32
    }
    fn double(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn round_small(self) -> u32 {
        (self + 8_388_608.0).to_bits() & 0x7F_FFFF
    }
}

impl Real for f64 {
    fn from_double(value: f64) -> f64 {
        value
    }
    fn from_integer(value: i32) -> f64 {
        f64::from(value)
    }
    fn double(self) -> f64 {
        self
    }
    #[inline(always)]
    fn round_small(self) -> u32 {
        (self + 4_503_599_627_370_496.0).to_bits() as u32
    }
}

/// Converts a lattice normal to a vector.
pub(crate) fn normal<R: Real>([x, y, z]: [i32; 3]) -> Vector3<R> {
    Vector3::new(R::from_integer(x), R::from_integer(y), R::from_integer(z))
}

/// Converts every component to another precision.
pub(crate) fn cast<A: Real, B: Real>(v: Vector3<A>) -> Vector3<B> {
    v.map(|x| B::from_double(x.double()))
}
