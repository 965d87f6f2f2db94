//! Free blocks as a gas: what kinetic theory says of their meetings.
//!
//! The gas is even, its speeds are Maxwell's, and a block is turned at random. In block units.
use std::f64::consts::PI;

use super::super::{Enclosure, Scene};
use super::BlockUnits;

/// The mean surface on which the centre of a cube is that touches another one, both turned at random
/// \[side^2\]: that of the sum of the two, twice the parallelograms of all pairs of their six edges.
/// The edges of one cube make 6, and nine pairs of different cubes 2 π/4 each, the mean of a sine.
const MEETING_SURFACE: f64 = 12.0 + 4.5 * PI;

/// The gas of a scene's free blocks, before any is captured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gas {
    /// Blocks per volume of the enclosure \[1/side^3\]; as a block has volume 1, also the part of it that they fill.
    pub density: f64,
    /// Area of the floor over the volume \[1/side\].
    floor: f64,
}

impl Gas {
    /// `None` without free blocks or without an enclosure around them. A sphere is a whole one, without the little that its plate cuts
    /// off.
    pub fn from_scene(scene: &Scene) -> Option<Gas> {
        let enclosure = scene.enclosure.as_ref()?;
        if scene.free.count == 0 {
            return None;
        }
        let radius = BlockUnits::from_scene(scene).length(enclosure.reach(scene.block.side));
        let ball = 4.0 / 3.0 * PI * radius.powi(3);
        let (volume, floor) = match enclosure {
            Enclosure::Hemisphere { .. } => (ball / 2.0, 1.5 / radius),
            Enclosure::Sphere { .. } => (ball, 0.0),
        };
        let density = f64::from(scene.free.count) / volume;
        (radius > 0.0).then_some(Gas { density, floor })
    }

    /// The mean way of a block between two meetings with others \[side\]: 1 / (√2 n S / 4), as the
    /// cross-section of convex bodies that are turned at random is a quarter of their surface.
    pub(crate) fn free_path(&self) -> f64 {
        1.0 / (2f64.sqrt() * self.density * MEETING_SURFACE / 4.0)
    }

    /// Meetings of a block with others in a tick, at an rms speed \[side/tick\].
    pub fn meetings(&self, rms: f64) -> f64 {
        mean(rms) / self.free_path()
    }

    /// Meetings of a block with the floor in a tick, at an rms speed \[side/tick\]: n v / 4 on each
    /// part of it.
    pub fn landings(&self, rms: f64) -> f64 {
        mean(rms) / 4.0 * self.floor
    }
}

/// The mean speed of a Maxwell distribution with an rms speed.
fn mean(rms: f64) -> f64 {
    rms * (8.0 / (3.0 * PI)).sqrt()
}
