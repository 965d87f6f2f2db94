//! Positions and motions of all blocks.
use std::ops::{Add, Sub};

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};
use stochc_control::Orientation;

use super::motion_groups::{MotionGroup, gather, group_and_lane, scatter};
use super::quaternion::{SMALL, columns, large, small, turned};
use super::simd::{ABREAST, LANES, Lane, Wide, filled, square, transposed};
use crate::world::blocks::{Blocks, Pose};
use crate::world::motion_limits::MotionLimits;
use crate::world::real::{Real, cast};
use crate::world::rotation::quaternion;
use crate::world::{BodyState, Fault};

/// All blocks, by number.
///
/// SIMD groups contain the data that every step needs. Rotations are updated only on access: a cube
/// has isotropic inertia, so its rotation rate changes only with its spin.
#[derive(Clone, Debug)]
pub(crate) struct Bodies<R: Lane> {
    /// Motions in SIMD groups. The last group is padded with permanently anchored blocks.
    groups: Vec<MotionGroup<R>>,
    attitudes: Vec<Attitude<R>>,
    /// Blocks whose matrices are up to date at `shown_at`, one bit each. Bits keep this list small
    /// enough for the cache.
    shown: Vec<u64>,
    shown_at: u64,
    /// Orientation in the structure. `None` if the block is free.
    anchored: Vec<Option<Orientation>>,
    anchored_count: usize,
    /// Number of completed short steps.
    pub now: u64,
    /// Length of a short step \[tick\].
    pub dt: R,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(bound = "")]
struct Attitude<R: Lane> {
    /// Rotation at the substep `turned`.
    rotation: UnitQuaternion<R>,
    turned: u64,
    /// Rotation as a matrix, as of its last update.
    axes: Rotation3<R>,
    spin: Vector3<R>,
}

stochc_ir::state! {
    (<R: Lane>) Bodies<R>;
    values: groups, attitudes, shown, shown_at, anchored, anchored_count, now;
    parts: ;
    same: dt
}

impl<R: Lane> Attitude<R> {
    /// Returns the rotation since `turned` that is not yet in `rotation`, as a rotation vector.
    fn late(&self, now: u64, dt: R) -> Vector3<R> {
        self.spin * (dt * R::from_double((now - self.turned) as f64))
    }
}

impl<R: Lane> Bodies<R> {
    /// Returns blocks that take steps of length `step`. `dt` is the shortest step that a block may
    /// take.
    pub fn new(blocks: &[BodyState], step: R, dt: R) -> Bodies<R> {
        let attitude = Attitude {
            rotation: UnitQuaternion::identity(),
            turned: 0,
            axes: Rotation3::identity(),
            spin: Vector3::zeros(),
        };
        let mut bodies = Bodies {
            groups: vec![MotionGroup::at_rest(step); blocks.len().div_ceil(LANES)],
            attitudes: vec![attitude; blocks.len()],
            shown: vec![0; blocks.len().div_ceil(64)],
            shown_at: 0,
            anchored: vec![None; blocks.len()],
            anchored_count: 0,
            now: 0,
            dt,
        };
        for (id, block) in (0..).zip(blocks) {
            let (group, lane) = group_and_lane(id);
            bodies.groups[group].mobility[lane] = R::one();
            bodies.set_state(id, block);
        }
        bodies
    }

    /// Returns all groups. The last group is padded.
    pub(super) fn groups(&self) -> &[MotionGroup<R>] {
        &self.groups
    }

    pub(super) fn groups_mut(&mut self) -> &mut [MotionGroup<R>] {
        &mut self.groups
    }

    /// Returns the length of a block's next step \[tick\].
    pub fn step(&self, id: u32) -> R {
        let (group, lane) = group_and_lane(id);
        self.groups[group].step[lane]
    }

    pub fn set_step(&mut self, id: u32, step: R) {
        let (group, lane) = group_and_lane(id);
        self.groups[group].step[lane] = step;
    }

    /// Sets the length of a block's last step \[tick\].
    pub fn set_last(&mut self, id: u32, step: R) {
        let (group, lane) = group_and_lane(id);
        self.groups[group].last[lane] = step;
    }

    /// Sets the velocity and spin of a block whose rotation is up to date.
    pub fn set_velocity_of_turned(&mut self, id: u32, velocity: Vector3<R>, spin: Vector3<R>) {
        self.set_moved(id, velocity);
        self.attitudes[id as usize].spin = spin;
    }

    /// Displaces a block, adds `faster` to its velocity and sets its spin. Returns its
    /// position, velocity, spin and rotation.
    pub fn correct(
        &mut self,
        id: u32,
        displacement: Vector3<R>,
        faster: Vector3<R>,
        spin: Vector3<R>,
    ) -> ([Vector3<R>; 3], UnitQuaternion<R>) {
        let rotation = self.rotation(id);
        self.attitudes[id as usize].spin = spin;
        self.shift(id, displacement);
        let (group, lane) = group_and_lane(id);
        let group = &mut self.groups[group];
        for axis in 0..3 {
            group.velocity[axis][lane] += faster[axis];
        }
        let position = gather(&group.position, lane);
        ([position, gather(&group.velocity, lane), spin], rotation)
    }

    /// Sets the velocity without updating the rotation.
    pub fn set_moved(&mut self, id: u32, velocity: Vector3<R>) {
        let (group, lane) = group_and_lane(id);
        scatter(&mut self.groups[group].velocity, lane, velocity);
    }

    pub fn set_position(&mut self, id: u32, position: Vector3<R>) {
        let (group, lane) = group_and_lane(id);
        let group = &mut self.groups[group];
        scatter(&mut group.position, lane, position);
        scatter(&mut group.rounded, lane, Vector3::zeros());
    }

    pub fn shift(&mut self, id: u32, displacement: Vector3<R>) {
        let (group, lane) = group_and_lane(id);
        let MotionGroup {
            position, rounded, ..
        } = &mut self.groups[group];
        for axis in 0..3 {
            let (coordinate, rounded) = (&mut position[axis][lane], &mut rounded[axis][lane]);
            (*coordinate, *rounded) = add(*coordinate, displacement[axis], *rounded);
        }
    }

    /// Returns the time over which forces act before a block's next move \[tick\]. Velocities lag
    /// positions by half a step.
    pub fn span(&self, id: u32) -> R {
        let (group, lane) = group_and_lane(id);
        let group = &self.groups[group];
        (group.step[lane] + group.last[lane]) * R::from_double(0.5)
    }

    /// Returns the time over which the force between two touching blocks acts \[tick\]. It is the
    /// longer of their times. One block may be anchored.
    pub fn span_of_pair(&self, [a, b]: [u32; 2]) -> R {
        let steps = |id: u32| {
            let (group, lane) = group_and_lane(id);
            let group = &self.groups[group];
            [&group.step, &group.last].map(|of| of[lane] * group.mobility[lane])
        };
        let ([step, last], [other_step, other_last]) = (steps(a), steps(b));
        (step.max(other_step) + last.max(other_last)) * R::from_double(0.5)
    }

    /// Returns the largest speed \[block lengths / tick\].
    pub fn fastest(&self) -> R {
        let mut most = R::Wide::splat(R::zero());
        for group in &self.groups {
            most = square(group.velocity.each_ref().map(R::Wide::load)).maximum(most);
        }
        let squares = most.store().into_iter();
        squares.fold(R::zero(), R::max).sqrt()
    }

    pub fn count_anchored(&self) -> usize {
        self.anchored_count
    }

    /// Returns the number of blocks with a coordinate beyond `span` \[block lengths\].
    pub fn count_beyond(&self, span: R) -> usize {
        let beyond = |&id: &u32| self.position(id).amax() > span;
        (0..self.count()).filter(beyond).count()
    }

    /// Returns the number of blocks above this height \[block lengths\].
    pub fn count_above(&self, height: R) -> usize {
        let above = |&id: &u32| self.position(id).z > height;
        (0..self.count()).filter(above).count()
    }

    /// Checks the motion of a block.
    ///
    /// # Errors
    ///
    /// If the motion of the block is invalid.
    pub fn check(&self, id: u32, limits: &MotionLimits) -> Result<(), Fault> {
        let motion = [self.position(id), self.velocity(id), self.spin(id)];
        limits.check(id, motion, &self.attitudes[id as usize].rotation)
    }

    /// Updates the rotation matrices of these blocks, several at a time.
    pub fn show(&mut self, ids: impl Iterator<Item = u32>) {
        if self.shown_at != self.now {
            self.shown_at = self.now;
            self.shown.fill(0);
        }
        let mut late = [0; ABREAST];
        let mut count = 0;
        ids.for_each(|id| {
            let (word, bit) = shown_bit(id);
            let shown = &mut self.shown[word];
            if *shown & bit == 0 {
                *shown |= bit;
                late[count % ABREAST] = id as usize;
                count += 1;
                if count == ABREAST {
                    self.show_abreast(&late);
                    count = 0;
                }
            }
        });
        if count > 0 {
            self.show_abreast(&late[..count]);
        }
    }

    /// Updates the rotation matrices of at least one and at most [`ABREAST`] blocks.
    fn show_abreast(&mut self, blocks: &[usize]) {
        let lanes = filled(blocks).map(|i| &self.attitudes[i]);
        let rotation = transposed(lanes.map(|of| of.rotation.coords.into()));
        let angle = transposed(lanes.map(|of| of.late(self.now, self.dt).into()));
        let of = |value: f64| R::Quad::splat(R::from_double(value));
        let s = square(angle) * of(0.25);
        let mut half = small(s, of);
        if of(SMALL).above(s).bits() != (1 << ABREAST) - 1 {
            let (mut cos, mut over) = (half.0.store(), half.1.store());
            for (lane, s) in s.store().into_iter().take(blocks.len()).enumerate() {
                if s >= R::from_double(SMALL) {
                    (cos[lane], over[lane]) = large(s);
                }
            }
            half = (R::Quad::load(&cos), R::Quad::load(&over));
        }
        let turned = turned(rotation, angle, half, of);
        let rests = s.above(of(0.0));
        let rotation = [0, 1, 2, 3].map(|axis| rests.choose(turned[axis], rotation[axis]));
        let columns = columns(rotation, of).map(|column| column.map(Wide::store));
        let rotation = rotation.map(Wide::store);
        for (lane, &i) in blocks.iter().enumerate() {
            let attitude = &mut self.attitudes[i];
            attitude.turned = self.now;
            attitude.rotation.as_mut_unchecked().coords = rotation.map(|lanes| lanes[lane]).into();
            let columns = columns.map(|column| column.map(|lanes| lanes[lane]));
            attitude.axes = Rotation3::from_matrix_unchecked(Matrix3::from(columns));
        }
    }

    /// Returns the rotation matrix from block to world axes, as of its last update.
    pub fn axes(&self, id: u32) -> &Rotation3<R> {
        &self.attitudes[id as usize].axes
    }

    /// Rotates a block about its centre at once.
    pub fn turn_now(&mut self, id: u32, angle: Vector3<R>) {
        let turned = turn(angle, self.rotation(id));
        self.attitudes[id as usize].rotation = turned;
        self.forget_axes(id);
    }

    /// Lists the free blocks with centres below a height, in ascending order.
    pub fn list_below(&self, height: R, found: &mut Vec<u32>) {
        found.clear();
        let (height, zero) = (R::Wide::splat(height), R::Wide::splat(R::zero()));
        for (first, group) in (0..).step_by(LANES).zip(&self.groups) {
            let is_low = height.above(R::Wide::load(&group.position[2]));
            let mut low = (is_low & R::Wide::load(&group.mobility).above(zero)).bits();
            while low != 0 {
                found.push(first + low.trailing_zeros());
                low &= low - 1;
            }
        }
    }

    /// Sets the position of a block, including the part that rounding removes.
    fn set_exact_position(&mut self, id: u32, position: Vector3<f64>) {
        self.set_position(id, cast(position));
        let stored: Vector3<f64> = cast(self.position(id));
        let (group, lane) = group_and_lane(id);
        scatter(
            &mut self.groups[group].rounded,
            lane,
            cast(stored - position),
        );
    }

    fn set_rotation(&mut self, id: u32, rotation: UnitQuaternion<f64>) {
        let attitude = &mut self.attitudes[id as usize];
        let rotation = rotation.coords.map(R::from_double);
        attitude.rotation = UnitQuaternion::from_quaternion(rotation.into());
        attitude.turned = self.now;
        self.forget_axes(id);
    }

    /// Marks the matrix of a block as out of date.
    fn forget_axes(&mut self, id: u32) {
        let (word, bit) = shown_bit(id);
        self.shown[word] &= !bit;
    }
}

impl<R: Lane> Blocks for Bodies<R> {
    type Real = R;

    fn count(&self) -> u32 {
        self.anchored.len() as u32
    }

    fn anchored(&self, id: u32) -> Option<Orientation> {
        self.anchored[id as usize]
    }

    fn position(&self, id: u32) -> Vector3<R> {
        let (group, lane) = group_and_lane(id);
        gather(&self.groups[group].position, lane)
    }

    fn exact_position(&self, id: u32) -> Vector3<f64> {
        let (group, lane) = group_and_lane(id);
        let rounded = gather(&self.groups[group].rounded, lane);
        cast::<R, f64>(self.position(id)) - cast(rounded)
    }

    fn velocity(&self, id: u32) -> Vector3<R> {
        let (group, lane) = group_and_lane(id);
        gather(&self.groups[group].velocity, lane)
    }

    fn spin(&self, id: u32) -> Vector3<R> {
        self.attitudes[id as usize].spin
    }

    fn rotation(&mut self, id: u32) -> UnitQuaternion<R> {
        let attitude = &mut self.attitudes[id as usize];
        if self.now > attitude.turned {
            let angle = attitude.late(self.now, self.dt);
            attitude.turned = self.now;
            attitude.rotation = turn(angle, attitude.rotation);
        }
        attitude.rotation
    }

    fn state(&self, id: u32) -> BodyState {
        let attitude = &self.attitudes[id as usize];
        let rotation = turn(attitude.late(self.now, self.dt), attitude.rotation);
        BodyState {
            position: self.exact_position(id),
            orientation: UnitQuaternion::from_quaternion(rotation.coords.map(Real::double).into()),
            velocity: cast(self.velocity(id)),
            spin: cast(attitude.spin),
        }
    }

    fn set_state(&mut self, id: u32, state: &BodyState) {
        self.set_exact_position(id, state.position);
        self.set_velocity_of_turned(id, cast(state.velocity), cast(state.spin));
        self.set_rotation(id, state.orientation);
    }

    fn set_pose(&mut self, id: u32, pose: &Pose) {
        self.set_exact_position(id, pose.position);
        self.set_rotation(id, pose.rotation);
    }

    fn set_velocity(&mut self, id: u32, velocity: Vector3<R>, spin: Vector3<R>) {
        if self.spin(id) != spin {
            // Applies the rotation so far before the spin changes.
            self.rotation(id);
        }
        self.set_velocity_of_turned(id, velocity, spin);
    }

    fn anchor(&mut self, id: u32, centre: Vector3<R>, orientation: Orientation) {
        let state = BodyState {
            orientation: quaternion(orientation),
            ..BodyState::at_rest(cast(centre))
        };
        self.set_state(id, &state);
        let before = self.anchored[id as usize].replace(orientation);
        self.anchored_count += usize::from(before.is_none());
        let (group, lane) = group_and_lane(id);
        self.groups[group].mobility[lane] = R::zero();
    }

    fn release(&mut self, id: u32) {
        let before = self.anchored[id as usize].take();
        self.anchored_count -= usize::from(before.is_some());
        let (group, lane) = group_and_lane(id);
        self.groups[group].mobility[lane] = R::one();
        self.set_moved(id, Vector3::zeros());
    }
}

/// Returns the word and bit that mark a block's matrix as up to date.
fn shown_bit(id: u32) -> (usize, u64) {
    (id as usize / 64, 1 << (id % 64))
}

/// Returns a position after a displacement, and its new rounding error. `rounded` is the
/// previous rounding error.
#[inline(always)]
pub(super) fn add<W: Copy + Add<Output = W> + Sub<Output = W>>(
    coordinate: W,
    displacement: W,
    rounded: W,
) -> (W, W) {
    let displacement = displacement - rounded;
    let moved = coordinate + displacement;
    (moved, (moved - coordinate) - displacement)
}

/// Returns `rotation` turned by a rotation vector. Exact for a constant spin.
fn turn<R: Real>(angle: Vector3<R>, rotation: UnitQuaternion<R>) -> UnitQuaternion<R> {
    let s = angle.norm_squared() * R::from_double(0.25);
    if s == R::zero() {
        return rotation;
    }
    let half = if s < R::from_double(SMALL) {
        small(s, R::from_double)
    } else {
        large(s)
    };
    let turned = turned(rotation.coords.into(), angle.into(), half, R::from_double);
    UnitQuaternion::new_unchecked(Quaternion::from(turned))
}
