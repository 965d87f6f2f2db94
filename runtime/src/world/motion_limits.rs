//! Limits of valid motion. Beyond them, a run fails.
use nalgebra::{UnitQuaternion, Vector3};

use super::Fault;
use super::real::Real;

/// Largest valid speed and spin \[block lengths / tick, rad / tick\].
const MAX_SPEED: f64 = 100.0;

/// Longest valid path per step in scenes with collisions \[block lengths\]. A longer one could pass
/// through a block or the ground.
const FARTHEST_STEP: f64 = 2.0;

/// Largest valid distance from the plate \[block lengths\]. Single precision cannot resolve
/// positions beyond it.
pub(crate) const FARTHEST: f64 = 1e5;

/// Limits of valid motion in a scene. `speed` is in \[block lengths / tick\], `spin` in \[rad /
/// tick\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct MotionLimits {
    pub speed: f64,
    pub spin: f64,
    /// Largest valid distance from the plate \[block lengths\].
    pub far: f64,
}

impl MotionLimits {
    /// Returns the limits for this number of steps per tick, with or without collisions.
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

    /// Returns these limits with a largest distance of at most `far`. The ground ends at `far`.
    #[cfg(feature = "rapier")]
    pub fn within(self, far: f64) -> MotionLimits {
        let far = self.far.min(far);
        MotionLimits { far, ..self }
    }

    /// Checks the position, velocity, spin and rotation of a block.
    ///
    /// # Errors
    ///
    /// If a value is not a number or exceeds its limit.
    #[inline(always)]
    pub fn check<R: Real>(
        &self,
        body: u32,
        [position, velocity, spin]: [Vector3<R>; 3],
        rotation: &UnitQuaternion<R>,
    ) -> Result<(), Fault> {
        // Fast path for blocks far from all limits.
        let below = |square: R, most: f64| square < R::from_double(0.99 * most * most);
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
        // Comparisons with NaN are false.
        let is_below = |value: f64, most: f64| value < most;
        let what = if !is_below(speed, MAX_SPEED) {
            format!("its speed is {speed} block lengths per tick")
        } else if !is_below(speed, self.speed) {
            format!(
                "its speed is {speed:.2} block lengths per tick, too fast to detect collisions; use more \
                 substeps"
            )
        } else if !is_below(spin, self.spin) {
            format!("its spin is {spin} radians per tick")
        } else if !is_below(far, self.far) {
            format!("it is {far} block lengths from the plate")
        } else if !rotation.coords.norm().double().is_finite() {
            "its orientation is not a number".to_owned()
        } else {
            return Ok(());
        };
        Err(Fault { body, what })
    }
}
