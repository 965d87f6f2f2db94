//! Uncalibrated estimates of rates.
use std::f64::consts::PI;
use std::ops::RangeInclusive;

use stochc_ir::scene::dimensionless::{BlockUnits, Gas, speed};
use stochc_ir::scene::{Bond, Enclosure, Scene};

use crate::geometry::accessibility::RADIUS;
use crate::waits::law::Parameters;
use crate::waits::rates::Rates;

/// Errors of estimated mean waiting times relative to calibrated ones: the rms factor and the
/// largest factor. Both are rounded up (docs/validation/rates.md).
pub const GUESS_ERROR: (f64, f64) = (1.5, 3.0);

/// Ratio of the pull's work to a block's energy when half of the blocks within reach dock.
const HALF: f64 = 2.13;

const STEEPNESS: f64 = 9.4;

/// Exponent of the density: dense blocks knock each other out of reach.
const CROWDING: f64 = 0.3;

/// Returns the parameters of the rate law for the logarithm `rate` of the rate and the docking
/// `probability`.
///
/// If few blocks dock, surroundings that slow blocks down matter more than the number of arriving
/// blocks. If all blocks dock, the number matters more. The other parameters are taken from `like`.
fn parameters(rate: f64, probability: f64, like: Parameters) -> Parameters {
    let fails = 1.0 - probability;
    let [
        ..,
        corner,
        corner_parent,
        rival,
        across,
        around,
        ahead,
        near_parent,
        depletion,
        _,
        _,
        _,
        docking_corner,
        docking_rival,
        cold,
    ] = like.0;
    Parameters([
        rate,
        1.17 * probability.sqrt(),
        0.25 + 1.25 * fails * fails,
        0.4 + libm::pow(fails, 6.0),
        0.75 * libm::pow(fails, 3.0) - 0.1,
        corner,
        corner_parent,
        rival,
        across,
        around,
        ahead,
        near_parent,
        depletion,
        4.65 + 2.4 * probability * fails,
        -0.25,
        -0.8,
        docking_corner,
        docking_rival,
        cold,
    ])
}

/// Validated range of the ratio of the pull's work to the energy of a block.
const WORKS: RangeInclusive<f64> = 1.2..=4.0;

/// Validated range of the density relative to the default scene.
const DENSITIES: RangeInclusive<f64> = 0.4..=2.5;

/// Number of layers of the density profile that are near the ground in every enclosure.
const LOW: usize = 12;

impl Rates {
    /// Returns an uncalibrated estimate from kinetic theory. The scene must be like the default
    /// one: magnets that are switched on, random impulses and drag. Returns `None` for other
    /// scenes, because the error of their estimate is unknown.
    ///
    /// Blocks of density n and mean speed v come within reach at the rate n v A / 4. A is the
    /// surface of the sphere of reach. They dock with probability 1 / (1 + (x₀ / x)^s). x is the
    /// pull's work divided by the energy of a block. The density near the ground and the head
    /// starts of released blocks are those of the default scene.
    pub fn first_guess(scene: &Scene) -> Option<Rates> {
        let Some(Bond::Attract { pull, .. }) = &scene.bond else {
            return None;
        };
        // A sphere has a different gas near the plate.
        let is_other = !matches!(scene.enclosure, Some(Enclosure::Hemisphere { .. }))
            || scene.uncalibrated_term().is_some();
        if is_other || scene.drag.is_none() || scene.contact.is_none() {
            return None;
        }
        let typical = Rates::shipped().first()?;
        let units = BlockUnits::from_scene(scene);
        let rms = units.speed(speed(scene).rms.filter(|rms| *rms > 0.0)?);
        let usual = Gas::from_scene(&typical.scene)?.density;
        let density = Gas::from_scene(scene)?.density;
        let reached = 4.0
            * PI
            * RADIUS
            * RADIUS
            * usual
            * libm::pow(density / usual, CROWDING)
            * rms
            * libm::sqrt(8.0 / (3.0 * PI))
            / 4.0;
        let work = units.force(pull.force) * units.length(pull.within) / (rms * rms / 2.0);
        let is_known = WORKS.contains(&work) && DENSITIES.contains(&(density / usual));
        if !is_known {
            return None;
        }
        let docks = 1.0 / (1.0 + libm::pow(HALF / work, STEEPNESS));
        let mut guess = Rates {
            scene: scene.clone(),
            simulated: "a first guess".to_owned(),
            captures: 0,
            free: scene.free.count,
            ..typical.clone()
        };
        guess.profile.truncate(LOW);
        let rate = libm::log(reached * docks);
        guess.parameters = parameters(rate.clamp(-30.0, 30.0), docks, typical.parameters);
        rate.is_finite().then_some(guess)
    }

    /// Returns whether the rates are an uncalibrated estimate.
    pub fn is_guess(&self) -> bool {
        self.captures == 0
    }
}
