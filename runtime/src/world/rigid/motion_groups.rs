//! Motions of blocks in groups of SIMD width.
//!
//! All data of a group are contiguous. A pass over all blocks reads memory in order, and one block
//! occupies few cache lines.
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::simd::LANES;
use crate::world::real::Real;

/// One number per block of a group.
type Lanes<R> = [R; LANES];

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
#[repr(align(64))]
pub(super) struct MotionGroup<R: Real> {
    pub position: [Lanes<R>; 3],
    /// 1 if the block is free, 0 if it is anchored.
    pub mobility: Lanes<R>,
    pub velocity: [Lanes<R>; 3],
    /// Length of a block's next step \[tick\].
    pub step: Lanes<R>,
    /// Rounding errors of the positions, to be subtracted. They preserve displacements that are
    /// smaller than the last digit of a position.
    ///
    /// # Source
    ///
    /// W. Kahan (1965), compensated summation.
    pub rounded: [Lanes<R>; 3],
    /// Length of a block's last step \[tick\].
    pub last: Lanes<R>,
}

impl<R: Real> MotionGroup<R> {
    /// Returns blocks anchored at the origin, for steps of this length.
    pub fn at_rest(step: R) -> MotionGroup<R> {
        let zeros = [R::zero(); LANES];
        MotionGroup {
            position: [zeros; 3],
            mobility: zeros,
            velocity: [zeros; 3],
            step: [step; LANES],
            rounded: [zeros; 3],
            last: [step; LANES],
        }
    }
}

/// Returns the index of a block's group and the block's index in the group.
#[inline(always)]
pub(super) fn group_and_lane(id: u32) -> (usize, usize) {
    let id = id as usize;
    (id / LANES, id % LANES)
}

/// Returns the vector of one block of a group.
#[inline(always)]
pub(super) fn gather<R: Real>(lanes: &[Lanes<R>; 3], lane: usize) -> Vector3<R> {
    Vector3::new(lanes[0][lane], lanes[1][lane], lanes[2][lane])
}

/// Sets the vector of one block of a group.
#[inline(always)]
pub(super) fn scatter<R: Real>(lanes: &mut [Lanes<R>; 3], lane: usize, value: Vector3<R>) {
    for (axis, lanes) in lanes.iter_mut().enumerate() {
        lanes[lane] = value[axis];
    }
}
