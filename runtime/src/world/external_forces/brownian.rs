//! Brownian motion: thermal fluctuations in balance with viscous drag.
use nalgebra::Vector3;

use super::drag::mean;
use crate::counter_rng::{Draws, Stream, gaussians};
use crate::world::blocks::Motion;
use crate::world::parameters::Resistance;
use crate::world::unit_cube::INVERSE_INERTIA;

/// Random velocity changes by Brownian motion in one step.
#[derive(Debug)]
pub(super) struct Brownian {
    /// Rms change per step of each velocity component \[block lengths / tick\] and of each spin
    /// component \[rad / tick\].
    rms: (f64, f64),
    step: u64,
    draws: Draws,
}

impl Brownian {
    /// Returns the random velocity changes of blocks in a fluid. `energy` is k T.
    pub fn new(fluid: &Resistance, energy: f64, dt: f64, seed: u64, run: u64) -> Brownian {
        Brownian {
            rms: (
                rms(fluid.viscous.0, energy, dt),
                rms(fluid.viscous.1, energy * INVERSE_INERTIA, dt),
            ),
            step: 0,
            draws: Draws::new(seed, run, Stream::Heat),
        }
    }

    pub fn begin(&mut self, step: u64) {
        self.step = step;
    }

    /// Adds a random velocity change to the motion of a block.
    pub fn shake(&mut self, id: u32, motion: &mut Motion) {
        let mut step = self.draws.step(self.step);
        let [x, y, z, a] = gaussians(step.block(2 * id));
        let [b, c, ..] = gaussians(step.block(2 * id + 1));
        motion.velocity += Vector3::new(x, y, z) * self.rms.0;
        motion.spin += Vector3::new(a, b, c) * self.rms.1;
    }
}

/// Returns the rms velocity change per step for a velocity that decays by `rate`. `energy` is the
/// variance of that velocity for short steps.
///
/// Let c = exp(-rate dt) be the fraction left after a step. The mean velocity of a step must have
/// variance 2 energy (1 - c) / (rate dt (1 + c)). Positions then diffuse with energy / rate for any
/// dt.
fn rms(rate: f64, energy: f64, dt: f64) -> f64 {
    let left = libm::exp(-rate * dt);
    let variance = 2.0 * energy * mean(rate * dt) / (1.0 + left);
    (variance * (1.0 - left * left)).sqrt()
}
