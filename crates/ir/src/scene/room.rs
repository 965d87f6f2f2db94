//! Check whether the free blocks of a scene fit into its enclosure at tick 0.
use std::f64::consts::{SQRT_2, TAU};
use std::fmt;

use super::groups::BlockUnits;
use super::{Arrangement, Scene};
use crate::table::plate::Plate;

/// Smallest distance of a centre from the ground and from the shell \[block lengths\].
pub const MARGIN: f64 = 1.0;

/// Smallest spacing of the initial lattice \[block lengths\], so that blocks do not touch.
pub const MIN_SPACING: f64 = 1.1;

/// Reason why the free blocks cannot be placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoRoom {
    /// The enclosure is too small.
    DoesNotFit {
        /// Number of blocks.
        count: u32,
        /// Number of blocks that fit.
        fits: u32,
    },
    /// There are free blocks but no enclosure.
    NoEnclosure {
        /// Number of blocks.
        count: u32,
    },
    /// Blocks on a circle overlap, or leave the enclosure.
    OnRing {
        /// Number of blocks.
        count: u32,
    },
}

impl fmt::Display for NoRoom {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NoRoom::DoesNotFit { count, fits } => write!(
                f,
                "{count} free blocks do not fit into the enclosure, which holds {fits}"
            ),
            NoRoom::NoEnclosure { count } => write!(
                f,
                "{count} free blocks cannot be spread uniformly without an enclosure"
            ),
            NoRoom::OnRing { count } => write!(
                f,
                "{count} free blocks on the circle touch each other or leave the enclosure"
            ),
        }
    }
}

/// Region available to the centres of free blocks, above the centre of the plate.
#[derive(Clone, Copy, Debug)]
pub struct Interior {
    /// Radius of the region \[block lengths\]. The shell exerts no force on block centres inside.
    pub radius: f64,
    /// Height of the region's centre above the ground \[block lengths\].
    pub height: f64,
}

impl Interior {
    /// Returns the height of rings and jets \[block lengths\]: the centre of a sphere, or half the
    /// height of a hemisphere.
    pub fn halfway(&self) -> f64 {
        if self.height > 0.0 {
            self.height
        } else {
            self.radius / 2.0
        }
    }

    /// Returns the lattice sites in the region \[block lengths\], in the order of z, y, x. The
    /// lattice is cubic with this spacing, and symmetric about the vertical axis.
    pub fn lattice(&self, spacing: f64) -> impl Iterator<Item = [f64; 3]> + use<> {
        let Interior { radius, height } = *self;
        let (radius, low) = (radius - MARGIN, MARGIN - height);
        let reach = (radius / spacing) as i64 + 1;
        let least = if low < 0.0 { -reach } else { 0 };
        let rows = (least..=reach).flat_map(move |k| (-reach..reach).map(move |j| (j, k)));
        rows.flat_map(move |(j, k)| (-reach..reach).map(move |i| [i, j, k]))
            .map(move |site| site.map(|n| (n as f64 + 0.5) * spacing))
            .filter(move |[x, y, z]| *z >= low && (x * x + y * y + z * z).sqrt() <= radius)
            .map(move |[x, y, z]| [x, y, z + height])
    }

    /// Checks whether blocks fit in this arrangement. `side` is the block length \[m\].
    ///
    /// # Errors
    ///
    /// If the blocks do not fit.
    pub fn has_room(&self, count: u32, arrangement: Arrangement, side: f64) -> Result<(), NoRoom> {
        match arrangement {
            Arrangement::Uniform => {
                if self.is_roomy(count) {
                    return Ok(());
                }
                let sites = self.lattice(MIN_SPACING).take(count as usize);
                match sites.count() as u32 {
                    fits if fits < count => Err(NoRoom::DoesNotFit { count, fits }),
                    _ => Ok(()),
                }
            }
            Arrangement::Ring { radius } => {
                let (radius, height) = (radius / side, self.halfway());
                let apart = 2.0 * radius * (TAU / f64::from(count) / 2.0).sin();
                let touches = count > 1 && apart < MIN_SPACING * SQRT_2;
                let is_outside = radius.hypot(height - self.height) > self.radius;
                if touches || is_outside || height < MARGIN {
                    Err(NoRoom::OnRing { count })
                } else {
                    Ok(())
                }
            }
        }
    }

    /// Returns whether all blocks fit in a box within the hemisphere. If they do, the sites need
    /// not be counted. Their number might exceed the memory.
    fn is_roomy(&self, count: u32) -> bool {
        let radius = self.radius - MARGIN;
        let along = |length: f64| (length / MIN_SPACING - 1.0).max(0.0);
        along(radius).powi(2) * along(radius / 2.0 - MARGIN) > f64::from(count)
    }
}

impl Scene {
    /// Checks whether the free blocks fit around a plate.
    ///
    /// # Errors
    ///
    /// If the blocks do not fit.
    pub fn has_room(&self, plate: &Plate) -> Result<(), NoRoom> {
        let count = self.free.count;
        if count == 0 {
            return Ok(());
        }
        let Some(enclosure) = &self.enclosure else {
            return Err(NoRoom::NoEnclosure { count });
        };
        let (side, units) = (self.block.side, BlockUnits::from_scene(self));
        let interior = Interior {
            radius: units.length(enclosure.reach(side)),
            height: units.length(enclosure.centre_height(plate, side)),
        };
        interior.has_room(count, self.free.arrangement, side)
    }
}
