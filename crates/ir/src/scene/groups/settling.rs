//! Sinking against stirring: how high free blocks are that gravity pulls down.
//!
//! What sinks at a speed w and is spread by a diffusivity D comes to rest with a density that falls as
//! exp(-z / h), h = D / w (the balance of fluxes, w n = -D dn/dz). docs/concepts/physical-model.md derives it, and holds it
//! against simulated profiles.
use std::f64::consts::PI;

use super::super::{Agitation, BOLTZMANN, Enclosure, Fluid, Scene, Turbulence};
use super::{BlockUnits, speed};

/// How blocks that are heavier than their fluid, or lighter, are spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settling {
    /// Over which the density of those that are lifted falls to 1/e \[m\].
    pub height: f64,
    /// The part of them that is lifted at all; where heat or kicks stir, all are.
    pub lifted: f64,
    /// Whether they are lighter than the fluid, and gather at the top.
    pub is_floating: bool,
    /// Where eddies stir, the speed of sinking over their vertical rms speed.
    pub speeds: Option<f64>,
}

impl Settling {
    /// Returns how weight and agitation spread blocks.
    ///
    /// `None` without weight, without agitation, and for sinking blocks without a floor.
    pub fn from_scene(scene: &Scene) -> Option<Settling> {
        let down = down(scene);
        if down > 0.0 && scene.contact.is_none() {
            return None;
        }
        let weight = down.abs();
        if weight == 0.0 {
            return None;
        }
        let at = |height: f64| Settling {
            height,
            lifted: 1.0,
            is_floating: down < 0.0,
            speeds: None,
        };
        match scene.agitation.as_ref()? {
            // k T / (m' g), whatever the drag.
            Agitation::Brownian { temperature } => Some(at(
                BOLTZMANN * temperature / (scene.inertial_mass() * weight)
            )),
            Agitation::Kicks { .. } => Some(at(kicked(scene, weight) / weight)),
            Agitation::Turbulence(turbulence) => eddies(scene, turbulence, weight, at(0.0)),
        }
    }

    /// The mean height above where blocks come to rest, where no roof keeps them lower \[m\].
    pub fn mean(&self) -> f64 {
        self.lifted * self.height
    }

    /// The part of the blocks that is more than so high above where they come to rest \[m\].
    pub fn above(&self, height: f64) -> f64 {
        if self.height > 0.0 {
            self.lifted * (-height / self.height).exp()
        } else {
            0.0
        }
    }
}

impl Settling {
    /// Returns the density of free blocks in a layer of cells, over their mean in the enclosure.
    ///
    /// The lowest layer is 1. Sinking blocks reach it wherever they lie.
    /// `None` without an enclosure.
    pub fn density_in(&self, scene: &Scene, layer: i32) -> Option<f64> {
        let enclosure = scene.enclosure.as_ref()?;
        let side = scene.block.side;
        if !self.is_floating && layer <= 1 {
            return Some(1.0);
        }
        let reach = enclosure.reach(side);
        let middle = match enclosure {
            Enclosure::Hemisphere { .. } => 0.0,
            Enclosure::Sphere { radius, .. } => *radius,
        };
        let top = middle + reach;
        let middle_of_layer = (f64::from(layer) - 0.5) * side;
        let area = |height: f64| (reach * reach - (height - middle).powi(2)).max(0.0);
        // Distances from the place of settled blocks: the roof, or half a block above the floor.
        let away = if self.is_floating {
            top - middle_of_layer
        } else {
            middle_of_layer - side / 2.0
        };
        let height_at = |away: f64| {
            if self.is_floating {
                top - away
            } else {
                away + side / 2.0
            }
        };
        let sum = |end: f64, weight: &dyn Fn(f64) -> f64| {
            let slice = end / f64::from(SLICES);
            let places = (0..SLICES).map(|slice_number| (f64::from(slice_number) + 0.5) * slice);
            places
                .map(|away| area(height_at(away)) * weight(away))
                .sum::<f64>()
                * slice
        };
        let thinned = |away: f64| (-away / self.height).exp();
        let spread = sum(top.min(FAR * self.height), &thinned);
        let part = thinned(away.max(0.0)) / spread;
        Some(if part.is_finite() {
            self.lifted * part * sum(top, &|_| 1.0)
        } else {
            0.0
        })
    }
}

/// Slices of the enclosure that a sum is made of.
const SLICES: u32 = 512;

/// Heights of the profile beyond which nothing of it is left.
const FAR: f64 = 40.0;

/// Returns the acceleration of a block at rest by weight and buoyancy. Positive is downward \[m/s^2\].
pub fn down(scene: &Scene) -> f64 {
    let density = scene.fluid.as_ref().and_then(|fluid| fluid.density);
    let displaced = density.map_or(0.0, |density| density * scene.block.side.powi(3));
    let borne = displaced / scene.block.mass;
    let inert = scene.block.mass / scene.inertial_mass();
    scene.gravity.unwrap_or(0.0) * (1.0 - borne) * inert
}

/// The mean square of the vertical velocity of blocks that are kicked, and land \[m^2/s^2\].
///
/// A third of the kicks' energy comes in, drag takes its part, and each of g / (v √(2π)) landings in a time
/// takes (1 - e²) of the 2 v² that those have who land. No more than in an even gas, where blocks
/// take energy from each other.
fn kicked(scene: &Scene, weight: f64) -> f64 {
    let units = BlockUnits::from_scene(scene);
    let gain = speed::kick(scene).powi(2) / 3.0;
    // Of `drag`, which acts at the end of a tick; a fluid takes 2 γ τ v² in it on the average.
    let lost = 1.0 / speed::left_by_drag(scene) - 1.0 + 2.0 * speed::viscous(scene);
    let landing = scene.contact.as_ref().map_or(0.0, |contact| {
        let restitution = speed::restitution(scene, contact, false);
        (1.0 - restitution * restitution) * (2.0 / PI).sqrt() * units.acceleration(weight)
    });
    // The root of lost v² + landing v = gain.
    let root = 2.0 * gain / (landing + (landing * landing + 4.0 * lost * gain).sqrt());
    let own = units.speed_si(root).powi(2);
    let even = speed(scene).rms.map(|rms| rms * rms / 3.0);
    even.map_or(own, |even| own.min(even))
}

fn eddies(scene: &Scene, turbulence: &Turbulence, weight: f64, at: Settling) -> Option<Settling> {
    let level = turbulence.speed(scene.flow.as_ref());
    let vertical = level * turbulence.vertical;
    if vertical == 0.0 {
        return Some(Settling { lifted: 0.0, ..at });
    }
    let sinking = terminal(scene, scene.inertial_mass() * weight)?;
    // What follows an eddy for a time t moves by σ t with it: D = σ² t. A block leaves it when its time is
    // over, or when it has crossed it.
    let across = turbulence.length / level.hypot(sinking);
    let followed = 1.0 / (1.0 / turbulence.time(level) + 1.0 / across);
    let against = sinking / vertical;
    Some(Settling {
        height: vertical * vertical * followed / sinking,
        // Only an eddy that is faster than the block sinks takes it from the floor.
        lifted: erfc(against / 2_f64.sqrt()),
        speeds: Some(against),
        ..at
    })
}

/// The speed at which drag bears a force \[m/s\]; `None`: nothing bears it.
fn terminal(scene: &Scene, force: f64) -> Option<f64> {
    let fluid = scene.fluid.as_ref()?;
    let side = scene.block.side;
    let linear = (fluid.viscosity).map_or(0.0, |viscosity| Fluid::friction(viscosity, side));
    let square = (fluid.density).map_or(0.0, |density| Fluid::wake(density, side));
    // The root of square v^2 + linear v = force, without a difference of nearly equal numbers.
    let speed = 2.0 * force / (linear + (linear * linear + 4.0 * square * force).sqrt());
    Some(speed).filter(|speed| speed.is_finite())
}

/// The part of a normal distribution that is farther than x √2 standard deviations from its mean, to
/// 1.5e-7 (M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 7.1.26), x not negative.
fn erfc(x: f64) -> f64 {
    const A: [f64; 5] = [
        0.254829592,
        -0.284496736,
        1.421413741,
        -1.453152027,
        1.061405429,
    ];
    let t = 1.0 / (1.0 + 0.3275911 * x);
    A.iter().rev().fold(0.0, |sum, a| (sum + a) * t) * (-x * x).exp()
}

#[cfg(test)]
mod tests {
    use super::erfc;

    /// Handbook of Mathematical Functions, table 7.1.
    #[test]
    fn the_tail_of_the_normal_distribution_is_that_of_the_table() {
        for (x, tail) in [
            (0.0, 1.0),
            (0.5, 0.4795001222),
            (1.0, 0.1572992071),
            (2.0, 0.0046777349),
        ] {
            assert!((erfc(x) - tail).abs() < 2e-7, "{x}: {}", erfc(x));
        }
    }
}
