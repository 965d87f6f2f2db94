//! Where every block is and how it moves, in arrays.
use nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use stochc_protocol::Orientation;

use super::lanes::{ABREAST, LANES, Lane, Wide, square, transposed};
use super::turn::{SMALL, columns, large, small, turned};
use crate::world::ambient::Motion;
use crate::world::groups::Flock;
use crate::world::magnet::Cloud;
use crate::world::magnet::pairs::Pose;
use crate::world::real::{Real, cast};
use crate::world::rotation::quaternion;
use crate::world::state::BodyState;

/// No substep.
const NEVER: u64 = u64::MAX;

/// The blocks by number.
///
/// Positions and velocities are one array per component, because every step reads all of them.
/// Orientations are brought up to date only when somebody looks: between two changes of its spin
/// a cube turns at a constant rate, whatever its motion, as its inertia is the same about all axes.
#[derive(Clone, Debug)]
pub(super) struct Bodies<R: Lane> {
    pub position: [Vec<R>; 3],
    pub velocity: [Vec<R>; 3],
    /// 1 if the block is free, 0 if it is anchored.
    ///
    /// These seven arrays are longer than there are blocks, by blocks that are anchored for ever, to
    /// make full groups of [`LANES`].
    pub mobility: Vec<R>,
    /// As of `turned`, by the number of the substep.
    rotation: Vec<UnitQuaternion<R>>,
    turned: Vec<u64>,
    /// The same as matrices, as of `shown`.
    axes: Vec<Rotation3<R>>,
    shown: Vec<u64>,
    pub spin: Vec<Vector3<R>>,
    /// How a block sits in the structure; `None`: it is free.
    pub anchored: Vec<Option<Orientation>>,
    /// Substeps that have passed.
    pub now: u64,
    /// Length of a substep \[tick\].
    pub dt: R,
}

impl<R: Lane> Bodies<R> {
    pub fn new(blocks: &[BodyState], dt: R) -> Bodies<R> {
        let zeros = vec![R::zero(); blocks.len().next_multiple_of(LANES)];
        let mut mobility = zeros.clone();
        mobility[..blocks.len()].fill(R::one());
        let mut bodies = Bodies {
            position: std::array::from_fn(|_| zeros.clone()),
            velocity: std::array::from_fn(|_| zeros.clone()),
            mobility,
            rotation: vec![UnitQuaternion::identity(); blocks.len()],
            turned: vec![0; blocks.len()],
            axes: vec![Rotation3::identity(); blocks.len()],
            shown: vec![NEVER; blocks.len()],
            spin: vec![Vector3::zeros(); blocks.len()],
            anchored: vec![None; blocks.len()],
            now: 0,
            dt,
        };
        for (i, block) in blocks.iter().enumerate() {
            bodies.set_state(i, block);
        }
        bodies
    }

    pub fn count(&self) -> usize {
        self.anchored.len()
    }

    pub fn is_free(&self, i: usize) -> bool {
        self.anchored[i].is_none()
    }

    pub fn centre(&self, i: usize) -> Vector3<R> {
        gather(&self.position, i)
    }

    pub fn velocity(&self, i: usize) -> Vector3<R> {
        gather(&self.velocity, i)
    }

    pub fn set_centre(&mut self, i: usize, centre: Vector3<R>) {
        scatter(&mut self.position, i, centre);
    }

    pub fn set_velocity(&mut self, i: usize, velocity: Vector3<R>) {
        scatter(&mut self.velocity, i, velocity);
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

    /// How many blocks have a coordinate beyond this \[side\].
    pub fn count_beyond(&self, span: R) -> usize {
        let beyond = |i: &usize| self.centre(*i).amax() > span;
        (0..self.count()).filter(beyond).count()
    }

    /// How a block was turned when somebody looked last.
    pub fn rotation(&self, i: usize) -> &UnitQuaternion<R> {
        &self.rotation[i]
    }

    /// How a block is turned now.
    pub fn rotation_now(&mut self, i: usize) -> UnitQuaternion<R> {
        let late = self.now - self.turned[i];
        if late > 0 {
            self.turned[i] = self.now;
            let angle = self.spin[i] * (self.dt * R::of(late as f64));
            self.rotation[i] = turn(angle, self.rotation[i]);
        }
        self.rotation[i]
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
        self.show_abreast(&late[..count]);
    }

    /// At most [`ABREAST`] of them.
    fn show_abreast(&mut self, blocks: &[usize]) {
        let rotation = transposed(blocks.iter().map(|&i| self.rotation[i].coords.into()));
        let angle = transposed(blocks.iter().map(|&i| {
            let late = R::of((self.now - self.turned[i]) as f64);
            (self.spin[i] * (self.dt * late)).into()
        }));
        let of = |value: f64| R::Quad::splat(R::of(value));
        let s = square(angle) * of(0.25);
        let mut half = small(s, of);
        if of(SMALL).above(s).bits() != (1 << ABREAST) - 1 {
            let (mut cos, mut over) = (half.0.store(), half.1.store());
            for (lane, s) in s.store().into_iter().enumerate() {
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
    pub fn axes(&self, i: usize) -> &Rotation3<R> {
        &self.axes[i]
    }

    /// Turns a block at once, about its centre.
    pub fn turn_now(&mut self, i: usize, angle: Vector3<R>) {
        self.rotation[i] = turn(angle, self.rotation_now(i));
        self.shown[i] = NEVER;
    }

    pub fn state(&self, i: usize) -> BodyState {
        let late = R::of((self.now - self.turned[i]) as f64);
        let rotation = turn(self.spin[i] * (self.dt * late), self.rotation[i]);
        BodyState {
            position: cast(self.centre(i)),
            orientation: UnitQuaternion::from_quaternion(rotation.coords.map(Real::double).into()),
            velocity: cast(self.velocity(i)),
            spin: cast(self.spin[i]),
        }
    }

    pub fn set_state(&mut self, i: usize, state: &BodyState) {
        self.set_centre(i, cast(state.position));
        self.set_velocity(i, cast(state.velocity));
        self.spin[i] = cast(state.spin);
        self.set_rotation(i, state.orientation);
    }

    /// Fixes a block.
    pub fn anchor(&mut self, i: usize, centre: Vector3<R>, orientation: Orientation) {
        self.set_centre(i, centre);
        self.set_velocity(i, Vector3::zeros());
        self.spin[i] = Vector3::zeros();
        self.set_rotation(i, quaternion(orientation));
        self.anchored[i] = Some(orientation);
        self.mobility[i] = R::zero();
    }

    /// Lets a block go, at rest.
    pub fn release(&mut self, i: usize) {
        self.anchored[i] = None;
        self.mobility[i] = R::one();
    }

    /// The free blocks, in rising order.
    pub fn list_free(&self, free: &mut Vec<u32>) {
        free.clear();
        free.extend((0..self.count() as u32).filter(|&id| self.is_free(id as usize)));
    }

    /// The free blocks whose centres are below a height, in rising order.
    pub fn list_below(&self, height: R, found: &mut Vec<u32>) {
        found.clear();
        let height = R::Wide::splat(height);
        for (group, z) in self.position[2].as_chunks::<LANES>().0.iter().enumerate() {
            let mut low = height.above(R::Wide::load(z)).bits();
            while low != 0 {
                let i = group * LANES + low.trailing_zeros() as usize;
                low &= low - 1;
                if i < self.count() && self.is_free(i) {
                    found.push(i as u32);
                }
            }
        }
    }

    /// Sets a free block's velocity and spin.
    pub fn set_velocity_of(&mut self, id: u32, velocity: Vector3<f64>, spin: Vector3<f64>) {
        let i = id as usize;
        self.set_velocity(i, cast(velocity));
        let spin = cast(spin);
        if self.spin[i] != spin {
            // What it is turned by now, it was turned to before its spin changes.
            self.rotation_now(i);
            self.spin[i] = spin;
        }
    }

    fn set_rotation(&mut self, i: usize, rotation: UnitQuaternion<f64>) {
        let rotation = rotation.coords.map(R::of);
        self.rotation[i] = UnitQuaternion::from_quaternion(rotation.into());
        self.turned[i] = self.now;
        self.shown[i] = NEVER;
    }
}

impl<R: Lane> Cloud<R> for Bodies<R> {
    fn position(&self, id: u32) -> Option<Vector3<R>> {
        let i = id as usize;
        self.is_free(i).then(|| self.centre(i))
    }

    fn rotation(&mut self, id: u32) -> UnitQuaternion<R> {
        self.rotation_now(id as usize)
    }
}

impl<R: Lane> Flock for Bodies<R> {
    fn pose(&mut self, id: u32) -> Pose {
        let i = id as usize;
        let rotation = self.rotation_now(i).coords.map(Real::double);
        Pose {
            position: cast(self.centre(i)),
            rotation: UnitQuaternion::from_quaternion(rotation.into()),
        }
    }

    fn motion(&self, id: u32) -> Motion {
        let i = id as usize;
        Motion {
            position: cast(self.centre(i)),
            velocity: cast(self.velocity(i)),
            spin: cast(self.spin[i]),
        }
    }

    fn set_pose(&mut self, id: u32, pose: &Pose) {
        self.set_centre(id as usize, cast(pose.position));
        self.set_rotation(id as usize, pose.rotation);
    }

    fn set_velocity(&mut self, id: u32, velocity: Vector3<f64>, spin: Vector3<f64>) {
        self.set_velocity_of(id, velocity, spin);
    }
}

fn gather<R: Real>(arrays: &[Vec<R>; 3], i: usize) -> Vector3<R> {
    Vector3::new(arrays[0][i], arrays[1][i], arrays[2][i])
}

fn scatter<R: Real>(arrays: &mut [Vec<R>; 3], i: usize, value: Vector3<R>) {
    for (axis, array) in arrays.iter_mut().enumerate() {
        array[i] = value[axis];
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
