//! Drag of a cube in a fluid: viscous (Stokes) and wake drag.
use nalgebra::Vector3;

use crate::world::blocks::Motion;
use crate::world::parameters::Resistance;

/// Effect of a constant force and of a constant torque over one step, as fractions of the effects
/// without drag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Response {
    pub linear: f64,
    pub angular: f64,
}

impl Response {
    /// Response without drag.
    pub const FREE: Response = Response {
        linear: 1.0,
        angular: 1.0,
    };
}

#[derive(Clone, Copy, Debug)]
pub(super) struct StepDrag {
    linear: Decay,
    angular: Decay,
    dt: f64,
}

/// Solution of v' = -rate v - wake |v| v over a step.
#[derive(Clone, Copy, Debug)]
struct Decay {
    /// Fraction of a velocity that remains after a step of viscous drag.
    left: f64,
    /// Remaining fraction of a velocity, averaged over the step. This is also the response to a
    /// constant force.
    mean: f64,
    wake: f64,
}

impl Decay {
    fn new(rate: f64, wake: f64, dt: f64) -> Decay {
        let lost = rate * dt;
        Decay {
            left: libm::exp(-lost),
            mean: mean(lost),
            wake,
        }
    }

    /// Returns the fraction of a velocity of this magnitude that remains after the step, by the
    /// exact solution.
    fn left(&self, speed: f64, dt: f64) -> f64 {
        self.left / (1.0 + self.wake * speed * self.mean * dt)
    }
}

/// Returns the remaining fraction of a velocity, averaged over a step: (1 - exp(-x)) / x. `x` is
/// the drag rate times the step.
pub(crate) fn mean(x: f64) -> f64 {
    if x < 1e-8 {
        1.0 - x / 2.0
    } else {
        -libm::expm1(-x) / x
    }
}

impl StepDrag {
    pub fn new(fluid: &Resistance, dt: f64) -> StepDrag {
        StepDrag {
            linear: Decay::new(fluid.viscous.0, fluid.wake.0, dt),
            angular: Decay::new(fluid.viscous.1, fluid.wake.1, dt),
            dt,
        }
    }

    pub fn response(&self) -> Response {
        Response {
            linear: self.linear.mean,
            angular: self.angular.mean,
        }
    }

    /// Slows a motion relative to a fluid with this `velocity` and `spin`.
    pub fn slow(&self, motion: &mut Motion, velocity: Vector3<f64>, spin: Vector3<f64>) {
        let relative = motion.velocity - velocity;
        motion.velocity = velocity + relative * self.linear.left(relative.norm(), self.dt);
        let relative = motion.spin - spin;
        motion.spin = spin + relative * self.angular.left(relative.norm(), self.dt);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decay_is_the_solution_of_its_equation() {
        for (rate, wake, dt) in [
            (0.3, 0.0, 1.0),
            (0.0, 0.4, 1.0),
            (0.3, 0.4, 1.0),
            (2.0, 0.1, 0.5),
        ] {
            let steps = 200_000;
            let h: f64 = dt / f64::from(steps);
            let mut speed: f64 = 1.7;
            for _ in 0..steps {
                // Midpoint rule.
                let slope = |v: f64| -rate * v - wake * v * v;
                speed += h * slope(speed + 0.5 * h * slope(speed));
            }
            let expected = 1.7 * Decay::new(rate, wake, dt).left(1.7, dt);
            assert!(
                (expected - speed).abs() < 1e-9,
                "{rate} {wake}: {expected} {speed}"
            );
        }
    }

    #[test]
    fn steps_of_a_decay_add_up() {
        let (whole, half) = (Decay::new(0.3, 0.4, 1.0), Decay::new(0.3, 0.4, 0.5));
        let once = 2.0 * whole.left(2.0, 1.0);
        let first = 2.0 * half.left(2.0, 0.5);
        assert!((once - first * half.left(first, 0.5)).abs() < 1e-12);
    }
}
