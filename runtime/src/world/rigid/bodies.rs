//! Where every block is and how it moves, in arrays.
use std::ops::{Add, Sub};

use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use stochc_protocol::Orientation;

use super::quaternion::{SMALL, columns, large, small, turned};
use super::simd::{ABREAST, LANES, Lane, Wide, filled, square, transposed};
use crate::world::blocks::{Blocks, Pose};
use crate::world::motion_limits::MotionLimits;
use crate::world::real::{Real, cast};
use crate::world::rotation::quaternion;
use crate::world::{BodyState, Fault};

/// No substep.
const NEVER: u64 = u64::MAX;

/// The blocks by number.
///
/// Positions and velocities are one array per component, because every step reads all of them.
/// Orientations are brought up to date only when somebody looks: between two changes of its spin
/// a cube turns at a constant rate, whatever its motion, as its inertia is the same about all axes.
#[derive(Clone, Debug)]
pub(crate) struct Bodies<R: Lane> {
    pub position: [Vec<R>; 3],
    /// What rounding has taken from the positions: to be subtracted (W. Kahan, 1965). Steps far smaller than the last digit of
    /// a place add up.
    pub rounded: [Vec<R>; 3],
    pub velocity: [Vec<R>; 3],
    /// 1 if the block is free, 0 if it is anchored.
    ///
    /// These twelve arrays are longer than there are blocks, by blocks that are anchored for ever, to
    /// make full groups of [`LANES`].
    pub mobility: Vec<R>,
    /// Length of the step that a block takes next, and of the one that it has taken last \[tick\].
    pub step: Vec<R>,
    pub last: Vec<R>,
    /// As of `turned`, by the number of the substep.
    rotation: Vec<UnitQuaternion<R>>,
    turned: Vec<u64>,
    /// The same as matrices, as of `shown`.
    axes: Vec<Rotation3<R>>,
    shown: Vec<u64>,
    spin: Vec<Vector3<R>>,
    /// How a block sits in the structure; `None`: it is free.
    anchored: Vec<Option<Orientation>>,
    /// Short steps that have passed.
    pub now: u64,
    /// Length of a short step \[tick\].
    pub dt: R,
}

stochc_ir::state! {
    (<R: Lane>) Bodies<R>;
    values: position, rounded, velocity, mobility, step, last, rotation, turned, axes, shown, spin, anchored, now;
    parts: ;
    same: dt
}

impl<R: Lane> Bodies<R> {
    /// `step`: how long a step is; `dt`: how long the shortest one is that a block may take.
    pub fn new(blocks: &[BodyState], step: R, dt: R) -> Bodies<R> {
        let zeros = vec![R::zero(); blocks.len().next_multiple_of(LANES)];
        let mut mobility = zeros.clone();
        mobility[..blocks.len()].fill(R::one());
        let mut bodies = Bodies {
            position: std::array::from_fn(|_| zeros.clone()),
            rounded: std::array::from_fn(|_| zeros.clone()),
            velocity: std::array::from_fn(|_| zeros.clone()),
            mobility,
            step: vec![step; zeros.len()],
            last: vec![step; zeros.len()],
            rotation: vec![UnitQuaternion::identity(); blocks.len()],
            turned: vec![0; blocks.len()],
            axes: vec![Rotation3::identity(); blocks.len()],
            shown: vec![NEVER; blocks.len()],
            spin: vec![Vector3::zeros(); blocks.len()],
            anchored: vec![None; blocks.len()],
            now: 0,
            dt,
        };
        for (id, block) in (0..).zip(blocks) {
            bodies.set_state(id, block);
        }
        bodies
    }

    /// Changes the motion of a block whose rotation is up to date.
    pub fn set_velocity_of_turned(&mut self, id: u32, velocity: Vector3<R>, spin: Vector3<R>) {
        scatter(&mut self.velocity, id, velocity);
        self.spin[id as usize] = spin;
    }

    /// Changes the velocity alone: the block turns as before.
    pub fn set_moved(&mut self, id: u32, velocity: Vector3<R>) {
        scatter(&mut self.velocity, id, velocity);
    }

    pub fn set_position(&mut self, id: u32, position: Vector3<R>) {
        scatter(&mut self.position, id, position);
        scatter(&mut self.rounded, id, Vector3::zeros());
    }

    /// Moves a block by this way.
    pub fn shift(&mut self, id: u32, way: Vector3<R>) {
        let i = id as usize;
        for axis in 0..3 {
            let place = &mut self.position[axis][i];
            (*place, self.rounded[axis][i]) = add(*place, way[axis], self.rounded[axis][i]);
        }
    }

    /// How long the forces of a block act that it is moved by next: velocities are half a step behind places.
    pub fn span(&self, id: u32) -> R {
        let i = id as usize;
        (self.step[i] + self.last[i]) * R::of(0.5)
    }

    /// How long the force acts between two blocks that touch, of which one may be anchored: as long as that on whoever takes
    /// the longer steps.
    pub fn span_of_pair(&self, [a, b]: [u32; 2]) -> R {
        let longer = |steps: &[R]| {
            let of = |id: u32| steps[id as usize] * self.mobility[id as usize];
            of(a).max(of(b))
        };
        (longer(&self.step) + longer(&self.last)) * R::of(0.5)
    }

    /// The greatest speed \[side / tick\].
    pub fn fastest(&self) -> R {
        let [x, y, z] = [0, 1, 2].map(|axis| self.velocity[axis].as_chunks::<LANES>().0.iter());
        let mut most = R::Wide::splat(R::zero());
        for ((x, y), z) in x.zip(y).zip(z) {
            most = square([x, y, z].map(R::Wide::load)).most(most);
        }
        let squares = most.store().into_iter();
        squares.fold(R::zero(), R::max).sqrt()
    }

    /// How many are anchored.
    pub fn count_anchored(&self) -> usize {
        self.anchored.iter().flatten().count()
    }

    /// How many blocks have a coordinate beyond this \[side\].
    pub fn count_beyond(&self, span: R) -> usize {
        let beyond = |&id: &u32| self.position(id).amax() > span;
        (0..self.count()).filter(beyond).count()
    }

    /// How many blocks are higher than this \[side\].
    pub fn count_above(&self, height: R) -> usize {
        let blocks = &self.position[2][..self.anchored.len()];
        blocks.iter().filter(|&&z| z > height).count()
    }

    /// # Errors
    /// If the motion of a block makes no sense.
    pub fn check(&self, id: u32, limits: &MotionLimits) -> Result<(), Fault> {
        let motion = [self.position(id), self.velocity(id), self.spin(id)];
        limits.check(id, motion, &self.rotation[id as usize])
    }

    /// Brings the matrices of these blocks up to date, several side by side.
    pub fn show(&mut self, ids: impl Iterator<Item = u32>) {
        let mut late = [0; ABREAST];
        let mut count = 0;
        for id in ids {
            let i = id as usize;
            if self.shown[i] != self.now {
                self.shown[i] = self.now;
                late[count] = i;
                count += 1;
                if count == ABREAST {
                    self.show_abreast(&late);
                    count = 0;
                }
            }
        }
        if count > 0 {
            self.show_abreast(&late[..count]);
        }
    }

    /// At most [`ABREAST`] of them, and at least one.
    fn show_abreast(&mut self, blocks: &[usize]) {
        let lanes = filled(blocks);
        let rotation = transposed(lanes.map(|i| self.rotation[i].coords.into()));
        let angle = transposed(lanes.map(|i| {
            let late = R::of((self.now - self.turned[i]) as f64);
            (self.spin[i] * (self.dt * late)).into()
        }));
        let of = |value: f64| R::Quad::splat(R::of(value));
        let s = square(angle) * of(0.25);
        let mut half = small(s, of);
        if of(SMALL).above(s).bits() != (1 << ABREAST) - 1 {
            let (mut cos, mut over) = (half.0.store(), half.1.store());
            for (lane, s) in s.store().into_iter().take(blocks.len()).enumerate() {
                if s >= R::of(SMALL) {
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
            self.turned[i] = self.now;
            self.rotation[i].as_mut_unchecked().coords = rotation.map(|lanes| lanes[lane]).into();
            let columns = columns.map(|column| column.map(|lanes| lanes[lane]));
            self.axes[i] = Rotation3::from_matrix_unchecked(Matrix3::from(columns));
        }
    }

    /// The same as a matrix, own directions to the world's, as of the last time that it was shown.
    pub fn axes(&self, id: u32) -> &Rotation3<R> {
        &self.axes[id as usize]
    }

    /// Turns a block at once, about its centre.
    pub fn turn_now(&mut self, id: u32, angle: Vector3<R>) {
        let turned = turn(angle, self.rotation(id));
        self.rotation[id as usize] = turned;
        self.shown[id as usize] = NEVER;
    }

    /// The free blocks whose centres are below a height, in rising order.
    pub fn list_below(&self, height: R, found: &mut Vec<u32>) {
        found.clear();
        let height = R::Wide::splat(height);
        for (group, z) in self.position[2].as_chunks::<LANES>().0.iter().enumerate() {
            let mut low = height.above(R::Wide::load(z)).bits();
            while low != 0 {
                let id = (group * LANES) as u32 + low.trailing_zeros();
                low &= low - 1;
                if id < self.count() && self.is_free(id) {
                    found.push(id);
                }
            }
        }
    }

    fn set_rotation(&mut self, id: u32, rotation: UnitQuaternion<f64>) {
        let i = id as usize;
        let rotation = rotation.coords.map(R::of);
        self.rotation[i] = UnitQuaternion::from_quaternion(rotation.into());
        self.turned[i] = self.now;
        self.shown[i] = NEVER;
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
        gather(&self.position, id)
    }

    fn velocity(&self, id: u32) -> Vector3<R> {
        gather(&self.velocity, id)
    }

    fn spin(&self, id: u32) -> Vector3<R> {
        self.spin[id as usize]
    }

    fn rotation(&mut self, id: u32) -> UnitQuaternion<R> {
        let i = id as usize;
        let late = self.now - self.turned[i];
        if late > 0 {
            self.turned[i] = self.now;
            let angle = self.spin[i] * (self.dt * R::of(late as f64));
            self.rotation[i] = turn(angle, self.rotation[i]);
        }
        self.rotation[i]
    }

    fn state(&self, id: u32) -> BodyState {
        let i = id as usize;
        let late = R::of((self.now - self.turned[i]) as f64);
        let rotation = turn(self.spin[i] * (self.dt * late), self.rotation[i]);
        BodyState {
            position: cast::<R, f64>(self.position(id)) - cast(gather(&self.rounded, id)),
            orientation: UnitQuaternion::from_quaternion(rotation.coords.map(Real::double).into()),
            velocity: cast(self.velocity(id)),
            spin: cast(self.spin[i]),
        }
    }

    fn set_state(&mut self, id: u32, state: &BodyState) {
        self.set_position(id, cast(state.position));
        let kept: Vector3<f64> = cast(self.position(id));
        scatter(&mut self.rounded, id, cast(kept - state.position));
        self.set_velocity_of_turned(id, cast(state.velocity), cast(state.spin));
        self.set_rotation(id, state.orientation);
    }

    fn set_pose(&mut self, id: u32, pose: &Pose) {
        self.set_position(id, cast(pose.position));
        self.set_rotation(id, pose.rotation);
    }

    fn set_velocity(&mut self, id: u32, velocity: Vector3<R>, spin: Vector3<R>) {
        if self.spin[id as usize] != spin {
            // What it is turned by now, it was turned to before its spin changes.
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
        self.anchored[id as usize] = Some(orientation);
        self.mobility[id as usize] = R::zero();
    }

    fn release(&mut self, id: u32, velocity: Vector3<R>) {
        self.anchored[id as usize] = None;
        self.mobility[id as usize] = R::one();
        scatter(&mut self.velocity, id, velocity);
    }
}

/// A place after a way, and what rounding has added to it; `rounded`: what it had added before.
#[inline(always)]
pub(super) fn add<W: Copy + Add<Output = W> + Sub<Output = W>>(
    place: W,
    way: W,
    rounded: W,
) -> (W, W) {
    let way = way - rounded;
    let moved = place + way;
    (moved, (moved - place) - way)
}

fn gather<R: Real>(arrays: &[Vec<R>; 3], id: u32) -> Vector3<R> {
    let i = id as usize;
    Vector3::new(arrays[0][i], arrays[1][i], arrays[2][i])
}

fn scatter<R: Real>(arrays: &mut [Vec<R>; 3], id: u32, value: Vector3<R>) {
    for (axis, array) in arrays.iter_mut().enumerate() {
        array[id as usize] = value[axis];
    }
}

/// `rotation`, turned by a rotation vector: exact for a constant spin.
fn turn<R: Real>(angle: Vector3<R>, rotation: UnitQuaternion<R>) -> UnitQuaternion<R> {
    let s = angle.norm_squared() * R::of(0.25);
    if s == R::zero() {
        return rotation;
    }
    let half = if s < R::of(SMALL) {
        small(s, R::of)
    } else {
        large(s)
    };
    let turned = turned(rotation.coords.into(), angle.into(), half, R::of);
    UnitQuaternion::new_unchecked(Quaternion::from(turned))
}
