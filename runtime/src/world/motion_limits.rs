//! Motions beyond which a world gives up, because what it computes would mean nothing.
use nalgebra::{UnitQuaternion, Vector3};

use super::Fault;
use super::real::Real;

/// A faster block \[side / tick, rad / tick\] is a fault.
const MAX_SPEED: f64 = 100.0;

/// Where blocks collide, one that moves farther \[side\] in a step is a fault: it could pass through
/// another one, or through the ground, unseen.
const FARTHEST_STEP: f64 = 2.0;

/// A block farther from the plate \[side\] is a fault: single precision resolves its place no more.
pub(crate) const FARTHEST: f64 = 1e5;

/// The greatest sound speed and spin \[side / tick, rad / tick\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct MotionLimits {
    pub speed: f64,
    pub spin: f64,
    /// The greatest sound distance from the plate \[side\].
    pub far: f64,
}

impl MotionLimits {
    /// For so many steps a tick, with or without collisions.
    pub fn new(substeps: u32, collide: bool) -> MotionLimits {
        let step = FARTHEST_STEP * f64::from(substeps);
        MotionLimits {
            speed: if collide {
                step.min(MAX_SPEED)
            } else {
                MAX_SPEED
            },
            spin: MAX_SPEED,
            far: FARTHEST,
        }
    }

    /// Where the ground ends sooner than the numbers do.
    pub fn within(self, far: f64) -> MotionLimits {
        let far = self.far.min(far);
        MotionLimits { far, ..self }
    }

    /// Checks the place, the velocity and the spin of a block, and how it is turned.
    ///
    /// # Errors
    /// If they make no sense.
    #[inline(always)]
    pub fn check<R: Real>(
        &self,
        body: u32,
        [position, velocity, spin]: [Vector3<R>; 3],
        rotation: &UnitQuaternion<R>,
    ) -> Result<(), Fault> {
        // Far from all limits is quicker to see than within them.
        let below = |square: R, most: f64| square < R::of(0.99 * most * most);
        if below(velocity.norm_squared(), self.speed)
            && below(spin.norm_squared(), self.spin)
            && below(position.norm_squared(), self.far)
            && below(rotation.coords.norm_squared(), 2.0)
        {
            return Ok(());
        }
        self.look_closely(body, [position, velocity, spin], rotation)
    }

    #[cold]
    fn look_closely<R: Real>(
        &self,
        body: u32,
        [position, velocity, spin]: [Vector3<R>; 3],
        rotation: &UnitQuaternion<R>,
    ) -> Result<(), Fault> {
        let [speed, spin, far] = [velocity, spin, position].map(|vector| vector.norm().double());
        // What is not a number is not below anything.
        let sound = |value: f64, most: f64| value < most;
        let what = if !sound(speed, MAX_SPEED) {
            format!("its speed is {speed} sides per tick")
        } else if !sound(speed, self.speed) {
            format!(
                "its speed is {speed:.2} sides per tick, too fast to detect collisions; use more \
                 substeps"
            )
        } else if !sound(spin, self.spin) {
            format!("its spin is {spin} radians per tick")
        } else if !sound(far, self.far) {
            format!("it is {far} sides from the plate")
        } else if !rotation.coords.norm().double().is_finite() {
            "its orientation is not a number".to_owned()
        } else {
            return Ok(());
        };
        Err(Fault { body, what })
    }
}
