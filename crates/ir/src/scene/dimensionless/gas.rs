//! Free blocks as a gas: collision rates from kinetic theory.
//!
//! Assumes uniform density, Maxwell's speed distribution and random orientations. In block units.
use std::f64::consts::PI;

use super::super::{Enclosure, Interior, Scene};
use super::BlockUnits;
use crate::table::plate::Plate;

/// Mean surface area of the excluded volume of two cubes with random orientations \[block
/// lengths^2\].
///
/// It is twice the area of the parallelograms of all pairs of the six edge directions. The pairs of
/// edges of the same cube contribute 6. Each of the nine other pairs contributes the mean of a
/// sine, π/4.
const MEETING_SURFACE: f64 = 12.0 + 4.5 * PI;

/// Mean perimeter of the excluded area of two squares with random orientations, divided by π
/// \[block lengths\]: the mean width of a target for a block in a plane. The perimeters of convex
/// bodies add up.
const MEETING_WIDTH: f64 = 8.0 / PI;

const NO_PLATE: Plate = Plate { width: 0, depth: 0 };

/// Gas of a scene's free blocks, before any capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gas {
    /// Number of blocks per volume of the enclosure \[1 / block length^3\]. Equal to the volume
    /// fraction, because a block has volume 1.
    pub density: f64,
    /// Floor area divided by volume \[1 / block length\].
    floor: f64,
    /// Whether the world is planar. `density` is then a number of blocks per area.
    is_flat: bool,
}

impl Gas {
    /// Returns the gas, or `None` without free blocks or enclosure. Neglects the part of a sphere
    /// that the plate cuts off.
    pub fn from_scene(scene: &Scene) -> Option<Gas> {
        let enclosure = scene.enclosure.as_ref()?;
        if scene.free.count == 0 {
            return None;
        }
        let units = BlockUnits::from_scene(scene);
        // The height of a ball above the plate does not matter.
        let interior = enclosure.interior(&NO_PLATE, units);
        let (volume, floor) = match interior {
            Interior::Ball { radius, .. } if radius > 0.0 => {
                let ball = 4.0 / 3.0 * PI * radius.powi(3);
                match enclosure {
                    Enclosure::Hemisphere { .. } => (ball / 2.0, 1.5 / radius),
                    _ => (ball, 0.0),
                }
            }
            Interior::Box { half, low, high } => {
                (4.0 * half[0] * half[1] * (high - low), 1.0 / (high - low))
            }
            Interior::Cylinder { radius, low, high } => {
                (PI * radius * radius * (high - low), 1.0 / (high - low))
            }
            Interior::Ball { .. } => return None,
        };
        let density = f64::from(scene.free.count) / volume;
        let is_flat = enclosure.is_flat();
        let floor = if is_flat { 0.0 } else { floor };
        (volume > 0.0 && floor >= 0.0).then_some(Gas {
            density,
            floor,
            is_flat,
        })
    }

    /// Returns the mean free path between blocks \[block lengths\]: 1 / (√2 n S / 4). The
    /// cross-section of randomly oriented convex bodies is a quarter of their surface.
    pub(crate) fn free_path(&self) -> f64 {
        let target = if self.is_flat {
            MEETING_WIDTH
        } else {
            MEETING_SURFACE / 4.0
        };
        1.0 / (2f64.sqrt() * self.density * target)
    }

    /// Returns the number of collisions of a block with other blocks per tick. `rms` is the rms
    /// speed \[block lengths / tick\].
    pub fn meetings(&self, rms: f64) -> f64 {
        let mean = if self.is_flat {
            rms * PI.sqrt() / 2.0
        } else {
            mean(rms)
        };
        mean / self.free_path()
    }

    /// Returns the number of collisions of a block with the floor per tick: n v / 4 per area. `rms`
    /// is the rms speed \[block lengths / tick\].
    pub fn landings(&self, rms: f64) -> f64 {
        mean(rms) / 4.0 * self.floor
    }
}

/// Returns the mean speed of a Maxwell distribution with this rms speed.
fn mean(rms: f64) -> f64 {
    rms * (8.0 / (3.0 * PI)).sqrt()
}
