//! Sedimentation against stirring: the height distribution of free blocks under gravity.
//!
//! Blocks that sink at speed w with diffusivity D reach a density profile exp(-z / h) with h = D /
//! w. This balances the fluxes, w n = -D dn/dz. docs/validation/physics.md compares it with
//! simulated profiles.
use std::f64::consts::PI;

use super::super::{Agitation, BOLTZMANN, Enclosure, Fluid, Mount, Scene, Turbulence};
use super::{BlockUnits, speed};

/// Height distribution of blocks with a density other than the fluid's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settling {
    /// Height over which the density of the lifted blocks falls to 1/e \[m\].
    pub height: f64,
    /// Fraction of the blocks that are lifted. 1 if Brownian motion or random impulses lift them.
    pub lifted: f64,
    /// Whether the blocks are lighter than the fluid and gather at the top.
    pub is_floating: bool,
    /// Ratio of sinking speed to the vertical rms speed of eddies, if there are eddies.
    pub speeds: Option<f64>,
}

impl Settling {
    /// Returns the height distribution by weight and agitation.
    ///
    /// Returns `None` without weight, without agitation, and for sinking blocks without a floor.
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
            // k T / (m' g), independent of drag.
            Agitation::Brownian { temperature } => Some(at(
                BOLTZMANN * temperature / (scene.inertial_mass() * weight)
            )),
            Agitation::Kicks { .. } => Some(at(kicked(scene, weight) / weight)),
            Agitation::Turbulence(turbulence) => eddies(scene, turbulence, weight, at(0.0)),
        }
    }

    /// Returns the mean height above the resting place \[m\], without an upper limit.
    pub fn mean(&self) -> f64 {
        self.lifted * self.height
    }

    /// Returns the fraction of blocks above this height over the resting place \[m\].
    pub fn above(&self, height: f64) -> f64 {
        if self.height > 0.0 {
            self.lifted * (-height / self.height).exp()
        } else {
            0.0
        }
    }
}

impl Settling {
    /// Returns the density of free blocks in a layer of cells, relative to their mean in the
    /// enclosure.
    ///
    /// The lowest layer is 1. Sinking blocks always reach the lowest layer. Returns `None` without
    /// an enclosure.
    pub fn density_in(&self, scene: &Scene, layer: i32) -> Option<f64> {
        let enclosure = scene.enclosure.as_ref()?;
        let side = scene.block.side;
        if !self.is_floating && layer <= 1 {
            return Some(1.0);
        }
        let middle_of_layer = (f64::from(layer) - 0.5) * side;
        let half = side / 2.0;
        // Height of the highest centre, and the area of a horizontal section, up to a factor.
        let (top, ball) = match *enclosure {
            Enclosure::Hemisphere { radius, .. } => (radius, Some((radius, 0.0))),
            Enclosure::Sphere { radius, .. } => {
                let reach = radius - half;
                (radius + reach, Some((reach, radius)))
            }
            Enclosure::Box { height, .. } | Enclosure::Cylinder { height, .. } => {
                (height - half, None)
            }
            Enclosure::Disc { .. } | Enclosure::Rectangle { .. } => return None,
        };
        let area = |height: f64| {
            ball.map_or(1.0, |(reach, middle)| {
                (reach * reach - (height - middle).powi(2)).max(0.0)
            })
        };
        // Distances from the resting place: the roof, or half a block above the floor.
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

/// Number of slices of the enclosure for a sum.
const SLICES: u32 = 512;

/// Number of scale heights after which the profile is negligible.
const FAR: f64 = 40.0;

/// Returns the acceleration that weight and buoyancy give a block at rest, positive towards the
/// floor of the structure \[m/s^2\]. Returns 0 in a planar world, and with a plate on a wall.
pub fn down(scene: &Scene) -> f64 {
    if scene.planar.is_some() {
        return 0.0;
    }
    match scene.mount {
        None => weight(scene),
        Some(Mount::Wall) => 0.0,
        Some(Mount::Roof) => -weight(scene),
    }
}

/// Returns the acceleration that presses a block against the floor or a wall, by its weight or its
/// buoyancy \[m/s^2\]. Returns 0 in a planar world.
pub(super) fn load(scene: &Scene) -> f64 {
    if scene.planar.is_some() {
        return 0.0;
    }
    weight(scene).abs()
}

/// Returns the weight of a block minus its buoyancy, divided by its inertial mass \[m/s^2\].
pub(super) fn weight(scene: &Scene) -> f64 {
    let density = scene.fluid.as_ref().and_then(|fluid| fluid.density);
    let displaced = density.map_or(0.0, |density| density * scene.block.side.powi(3));
    let borne = displaced / scene.block.mass;
    let inert = scene.block.mass / scene.inertial_mass();
    scene.gravity.unwrap_or(0.0) * (1.0 - borne) * inert
}

/// Returns the mean square of the vertical velocity of blocks under random impulses and gravity
/// \[m^2/s^2\].
///
/// One third of the impulses' energy is vertical, and drag removes a part. A block lands g / (v
/// √(2π)) times per unit of time. Landing blocks have the mean square velocity 2 v², and a landing
/// removes the fraction 1 - e² of it. The result is at most the value for a uniform gas, whose
/// blocks exchange energy.
fn kicked(scene: &Scene, weight: f64) -> f64 {
    let units = BlockUnits::from_scene(scene);
    let gain = speed::kick(scene).powi(2) / 3.0;
    // The clause `drag` acts at the end of a tick. A fluid removes 2 γ τ v² per tick on average.
    let lost = 1.0 / speed::left_by_drag(scene) - 1.0 + 2.0 * speed::viscous(scene);
    let landing = scene.contact.as_ref().map_or(0.0, |contact| {
        let restitution = speed::restitution(scene, contact, false);
        (1.0 - restitution * restitution) * (2.0 / PI).sqrt() * units.acceleration(weight)
    });
    // Solution of lost v² + landing v = gain.
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
    // Following an eddy for a time t gives D = σ² t. A block leaves it after its lifetime or after
    // crossing it.
    let across = turbulence.length / level.hypot(sinking);
    let followed = 1.0 / (1.0 / turbulence.time(level) + 1.0 / across);
    let against = sinking / vertical;
    Some(Settling {
        height: vertical * vertical * followed / sinking,
        // Only eddies faster than the sinking speed lift blocks from the floor.
        lifted: erfc(against / 2_f64.sqrt()),
        speeds: Some(against),
        ..at
    })
}

/// Returns the terminal speed under a force \[m/s\], or `None` without drag.
fn terminal(scene: &Scene, force: f64) -> Option<f64> {
    let fluid = scene.fluid.as_ref()?;
    let side = scene.block.side;
    let linear = (fluid.viscosity).map_or(0.0, |viscosity| Fluid::friction(viscosity, side));
    let square = (fluid.density).map_or(0.0, |density| Fluid::wake(density, side));
    // Root of square v^2 + linear v = force, without cancellation.
    let speed = 2.0 * force / (linear + (linear * linear + 4.0 * square * force).sqrt());
    Some(speed).filter(|speed| speed.is_finite())
}

/// Returns the fraction of a normal distribution that is more than x √2 standard deviations from
/// its mean, on both sides. Requires x of at least 0. Accurate within 1.5e-7.
///
/// # Source
///
/// M. Abramowitz and I. A. Stegun, Handbook of Mathematical Functions, 7.1.26.
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

    /// Compares with table 7.1 of the Handbook of Mathematical Functions.
    #[test]
    fn the_normal_tail_agrees_with_the_table() {
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
