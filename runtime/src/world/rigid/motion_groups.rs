//! How blocks move, in groups of as many as are computed with side by side.
//!
//! All that a step needs of a group lies together: a pass over all blocks is one stream through the memory, and what is asked of
//! a single block is in few lines of the cache.
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::simd::LANES;
use crate::world::real::Real;

/// A number of each block of a group.
type Lanes<R> = [R; LANES];

/// The motion of so many blocks.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
#[repr(align(64))]
pub(super) struct MotionGroup<R: Real> {
    pub position: [Lanes<R>; 3],
    /// 1 if the block is free, 0 if it is anchored.
    pub mobility: Lanes<R>,
    pub velocity: [Lanes<R>; 3],
    /// Length of the step that a block takes next \[tick\].
    pub step: Lanes<R>,
    /// What rounding has taken from the positions: to be subtracted (W. Kahan, 1965). Steps far smaller than the last digit of
    /// a place add up.
    pub rounded: [Lanes<R>; 3],
    /// Length of the step that a block has taken last \[tick\].
    pub last: Lanes<R>,
}

impl<R: Real> MotionGroup<R> {
    /// Blocks that are anchored at the origin, for steps of this length.
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

/// The group of a block, and its lane there.
#[inline(always)]
pub(super) fn place(id: u32) -> (usize, usize) {
    let id = id as usize;
    (id / LANES, id % LANES)
}

/// The vector of one block.
#[inline(always)]
pub(super) fn gather<R: Real>(lanes: &[Lanes<R>; 3], lane: usize) -> Vector3<R> {
    Vector3::new(lanes[0][lane], lanes[1][lane], lanes[2][lane])
}

/// Makes it another one.
#[inline(always)]
pub(super) fn scatter<R: Real>(lanes: &mut [Lanes<R>; 3], lane: usize, value: Vector3<R>) {
    for (axis, lanes) in lanes.iter_mut().enumerate() {
        lanes[lane] = value[axis];
    }
}
