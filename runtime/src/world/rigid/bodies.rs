//! Where every block is and how it moves, in arrays.
use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};

use super::lanes::LANES;
use crate::orientation::Orientation;
use crate::world::ambient::Motion;
use crate::world::groups::Flock;
use crate::world::magnet::Cloud;
use crate::world::magnet::pairs::Pose;
use crate::world::real::{Real, cast};
use crate::world::state::BodyState;

/// No substep.
const NEVER: u64 = u64::MAX;

/// The blocks by number.
///
/// Positions and velocities are one array per component, because every step reads all of them.
/// Orientations are brought up to date only when somebody looks: between two changes of its spin
/// a cube turns at a constant rate, whatever its motion, as its inertia is the same about all axes.
#[derive(Clone, Debug)]
pub(super) struct Bodies<R: Real> {
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

impl<R: Real> Bodies<R> {
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

    /// The same as a matrix: own directions to the world's.
    pub fn axes_now(&mut self, i: usize) -> &Rotation3<R> {
        if self.shown[i] != self.now {
            self.shown[i] = self.now;
            self.axes[i] = self.rotation_now(i).to_rotation_matrix();
        }
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
        self.set_rotation(i, orientation.quaternion());
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

impl<R: Real> Cloud<R> for Bodies<R> {
    fn position(&self, id: u32) -> Option<Vector3<R>> {
        let i = id as usize;
        self.is_free(i).then(|| self.centre(i))
    }

    fn rotation(&mut self, id: u32) -> UnitQuaternion<R> {
        self.rotation_now(id as usize)
    }
}

impl<R: Real> Flock for Bodies<R> {
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
    // Half the angle: cosine, and sine over the angle itself.
    let (cos, over) = if s < R::of(0.04) {
        // Both series are cut where the next term is below 1e-10.
        let nest = |s: R, by: [f64; 4]| {
            let term = |sum, &by| R::one() - s * R::of(1.0 / by) * sum;
            by.iter().rev().fold(R::one(), term)
        };
        let cos = nest(s, [2.0, 12.0, 30.0, 56.0]);
        let sinc = nest(s, [6.0, 20.0, 42.0, 72.0]);
        (cos, sinc * R::of(0.5))
    } else {
        let half = s.double().sqrt();
        let (sin, cos) = libm::sincos(half);
        (R::of(cos), R::of(sin / half / 2.0))
    };
    let by = Quaternion::from_parts(cos, angle * over);
    let turned = by * rotation.into_inner();
    // It is so close to one that one step of Newton's for the root will do.
    let factor = (R::of(3.0) - turned.norm_squared()) * R::of(0.5);
    UnitQuaternion::new_unchecked(turned * factor)
}
