//! Enclosures of the free blocks, and the regions that they leave to the blocks.
use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::dimensionless::BlockUnits;
use crate::Cell;
use crate::table::plate::Plate;

/// Enclosure of the free blocks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Enclosure {
    /// Hemisphere on the ground: a flat solid floor at z = 0, and an elastic wall.
    Hemisphere {
        /// Radius of the wall \[m\].
        radius: f64,
        /// Inward force on the centre of a block outside the wall, per depth \[N/m\].
        wall: f64,
    },
    /// Sphere, cut off by the ground so that the cut circumscribes the plate. Without a plate it
    /// touches the ground.
    Sphere {
        /// Radius of the wall \[m\].
        radius: f64,
        /// Inward force on a block whose inscribed sphere extends beyond the wall, per depth
        /// \[N/m\].
        wall: f64,
    },
    /// Box on the ground, with the centre of the plate in the middle of its floor. Its sides and
    /// its lid are elastic.
    Box {
        /// Length from west to east \[m\].
        length: f64,
        /// Width from south to north \[m\].
        width: f64,
        /// Height of the lid above the ground \[m\].
        height: f64,
        /// Inward force on a block whose inscribed sphere extends beyond a wall, per depth \[N/m\].
        wall: f64,
    },
    /// Cylinder that stands on the ground around the centre of the plate. Its side and its lid are
    /// elastic.
    Cylinder {
        /// Radius \[m\].
        radius: f64,
        /// Height of the lid above the ground \[m\].
        height: f64,
        /// Inward force on a block whose inscribed sphere extends beyond a wall, per depth \[N/m\].
        wall: f64,
    },
    /// Circle around the centre of the plate, in a planar world.
    Disc {
        /// Radius \[m\].
        radius: f64,
        /// Inward force on a block whose inscribed circle extends beyond the wall, per depth
        /// \[N/m\].
        wall: f64,
    },
    /// Rectangle around the centre of the plate, in a planar world.
    Rectangle {
        /// Length from west to east \[m\].
        length: f64,
        /// Width from south to north \[m\].
        width: f64,
        /// Inward force on a block whose inscribed circle extends beyond a wall, per depth \[N/m\].
        wall: f64,
    },
}

/// Distance that a body reaches in one dimension of an enclosure, and the limit \[m\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Keyword of the dimension, such as `radius`.
    pub dimension: &'static str,
    /// Origin of the distance, such as `from the centre`.
    pub origin: &'static str,
    /// Description of the limit, such as `the radius`.
    pub limited_by: &'static str,
    /// Distance of the farthest point of the body.
    pub reached: f64,
    /// Largest distance inside the enclosure.
    pub limit: f64,
}

impl Extent {
    /// Returns whether the body extends beyond the enclosure. Ignores rounding errors.
    pub fn is_outside(&self) -> bool {
        self.reached > self.limit * (1.0 + 1e-12)
    }
}

impl Enclosure {
    /// Returns the force on a block per depth in the wall \[N/m\].
    pub fn wall(&self) -> f64 {
        match *self {
            Enclosure::Hemisphere { wall, .. }
            | Enclosure::Sphere { wall, .. }
            | Enclosure::Box { wall, .. }
            | Enclosure::Cylinder { wall, .. }
            | Enclosure::Disc { wall, .. }
            | Enclosure::Rectangle { wall, .. } => wall,
        }
    }

    /// Returns whether the enclosure is for planar worlds.
    pub fn is_flat(&self) -> bool {
        matches!(self, Enclosure::Disc { .. } | Enclosure::Rectangle { .. })
    }

    /// Returns the keywords and the values of all lengths \[m\].
    pub fn lengths(&self) -> Vec<(&'static str, f64)> {
        let mut copy = self.clone();
        let lengths = copy.lengths_mut().into_iter();
        lengths.map(|(name, value)| (name, *value)).collect()
    }

    /// Returns the keywords and the places of all lengths \[m\].
    pub fn lengths_mut(&mut self) -> Vec<(&'static str, &mut f64)> {
        match self {
            Enclosure::Hemisphere { radius, .. }
            | Enclosure::Sphere { radius, .. }
            | Enclosure::Disc { radius, .. } => {
                vec![("radius", radius)]
            }
            Enclosure::Box {
                length,
                width,
                height,
                ..
            } => vec![("length", length), ("width", width), ("height", height)],
            Enclosure::Cylinder { radius, height, .. } => {
                vec![("radius", radius), ("height", height)]
            }
            Enclosure::Rectangle { length, width, .. } => {
                vec![("length", length), ("width", width)]
            }
        }
    }

    /// Returns the radius of the largest horizontal circle around the axis inside the enclosure
    /// \[m\].
    pub fn radius(&self) -> f64 {
        match *self {
            Enclosure::Hemisphere { radius, .. }
            | Enclosure::Sphere { radius, .. }
            | Enclosure::Cylinder { radius, .. }
            | Enclosure::Disc { radius, .. } => radius,
            Enclosure::Box { length, width, .. } | Enclosure::Rectangle { length, width, .. } => {
                length.min(width) / 2.0
            }
        }
    }

    /// Returns the height of the centre of the wall above the ground \[m\], for a plate of blocks
    /// with the length `side` \[m\]. 0 for a hemisphere, a box and a cylinder.
    pub(crate) fn centre_height(&self, plate: &Plate, side: f64) -> f64 {
        match *self {
            Enclosure::Sphere { radius, .. } => {
                let corner = f64::from(plate.width).hypot(f64::from(plate.depth)) / 2.0 * side;
                (radius * radius - corner * corner).max(0.0).sqrt()
            }
            _ => 0.0,
        }
    }

    /// Returns the region of block centres that no wall pushes, in block lengths. In a planar world,
    /// the centres are halfway between its lower and its upper side, which no block reaches.
    pub fn interior(&self, plate: &Plate, units: BlockUnits) -> Interior {
        let half = units.side / 2.0;
        match *self {
            Enclosure::Hemisphere { radius, .. } => Interior::Ball {
                radius: units.length(radius),
                height: 0.0,
            },
            Enclosure::Sphere { radius, .. } => Interior::Ball {
                radius: units.length(radius - half),
                height: units.length(self.centre_height(plate, units.side)),
            },
            Enclosure::Box {
                length,
                width,
                height,
                ..
            } => Interior::Box {
                half: [length, width].map(|across| units.length(across / 2.0 - half)),
                low: 0.5,
                high: units.length(height - half),
            },
            Enclosure::Cylinder { radius, height, .. } => Interior::Cylinder {
                radius: units.length(radius - half),
                low: 0.5,
                high: units.length(height - half),
            },
            Enclosure::Disc { radius, .. } => Interior::Cylinder {
                radius: units.length(radius - half),
                low: 0.0,
                high: 1.0,
            },
            Enclosure::Rectangle { length, width, .. } => Interior::Box {
                half: [length, width].map(|across| units.length(across / 2.0 - half)),
                low: 0.0,
                high: 1.0,
            },
        }
    }

    /// Returns how far a block in `cell` reaches in each dimension, for blocks with the length
    /// `side` \[m\].
    pub fn extents(&self, cell: Cell, plate: &Plate, side: f64) -> Vec<Extent> {
        let centre = |edge: u32| (f64::from(edge) - 1.0) / 2.0;
        let x = (f64::from(cell.x) - centre(plate.width)).abs() + 0.5;
        let y = (f64::from(cell.y) - centre(plate.depth)).abs() + 0.5;
        let (top, bottom) = (f64::from(cell.z), f64::from(cell.z) - 1.0);
        match *self {
            Enclosure::Hemisphere { radius, .. } | Enclosure::Sphere { radius, .. } => {
                let middle = self.centre_height(plate, side) / side;
                let z = (top - middle).abs().max((bottom - middle).abs());
                vec![Extent::radius(
                    (x * x + y * y + z * z).sqrt() * side,
                    radius,
                )]
            }
            Enclosure::Box { height, .. } | Enclosure::Cylinder { height, .. } => {
                let mut extents = self.plate_extents(2.0 * x, 2.0 * y, side);
                extents.push(Extent::height(top * side, height));
                extents
            }
            Enclosure::Disc { .. } | Enclosure::Rectangle { .. } => {
                self.plate_extents(2.0 * x, 2.0 * y, side)
            }
        }
    }

    /// Returns how far a rectangle around the centre of the plate reaches, of `width` by `depth`
    /// blocks with the length `side` \[m\].
    pub fn plate_extents(&self, width: f64, depth: f64, side: f64) -> Vec<Extent> {
        let from_middle = |dimension, limited_by, blocks: f64, limit: f64| Extent {
            dimension,
            origin: "from the middle",
            limited_by,
            reached: blocks / 2.0 * side,
            limit: limit / 2.0,
        };
        match *self {
            Enclosure::Hemisphere { radius, .. } | Enclosure::Sphere { radius, .. } => {
                vec![Extent::radius(width.hypot(depth) / 2.0 * side, radius)]
            }
            Enclosure::Box {
                length,
                width: across,
                ..
            }
            | Enclosure::Rectangle {
                length,
                width: across,
                ..
            } => vec![
                from_middle("length", "half of the length", width, length),
                from_middle("width", "half of the width", depth, across),
            ],
            Enclosure::Cylinder { radius, .. } | Enclosure::Disc { radius, .. } => vec![Extent {
                origin: "from the axis",
                ..Extent::radius(width.hypot(depth) / 2.0 * side, radius)
            }],
        }
    }

    /// Returns the volume \[m^3\], or the area \[m^2\] in a planar world. Neglects the part of a sphere
    /// that the plate cuts off.
    pub fn volume(&self) -> f64 {
        match *self {
            Enclosure::Hemisphere { radius, .. } => 2.0 / 3.0 * PI * radius.powi(3),
            Enclosure::Sphere { radius, .. } => 4.0 / 3.0 * PI * radius.powi(3),
            Enclosure::Box {
                length,
                width,
                height,
                ..
            } => length * width * height,
            Enclosure::Cylinder { radius, height, .. } => PI * radius * radius * height,
            Enclosure::Disc { radius, .. } => PI * radius * radius,
            Enclosure::Rectangle { length, width, .. } => length * width,
        }
    }
}

impl Extent {
    fn radius(reached: f64, limit: f64) -> Extent {
        Extent {
            dimension: "radius",
            origin: "from the centre",
            limited_by: "the radius",
            reached,
            limit,
        }
    }

    fn height(reached: f64, limit: f64) -> Extent {
        Extent {
            dimension: "height",
            origin: "above the floor",
            limited_by: "the height",
            reached,
            limit,
        }
    }
}

/// Region available to the centres of free blocks, around the vertical axis through the centre of
/// the plate. In block lengths. No wall exerts a force on a centre inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interior {
    /// Ball. Solid ground cuts it off.
    Ball {
        /// Radius.
        radius: f64,
        /// Height of its centre above the ground.
        height: f64,
    },
    /// Box.
    Box {
        /// Half of its extent from west to east, and from south to north.
        half: [f64; 2],
        /// Height of its lower side.
        low: f64,
        /// Height of its upper side.
        high: f64,
    },
    /// Standing cylinder.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Height of its lower side.
        low: f64,
        /// Height of its upper side.
        high: f64,
    },
}

impl Interior {
    /// Returns whether the region is one of a planar world.
    pub fn is_flat(&self) -> bool {
        matches!(self, Interior::Box { low, .. } | Interior::Cylinder { low, .. } if *low == 0.0)
    }

    /// Returns the signed distance of a point from the surface. It is negative inside.
    pub fn distance(&self, [x, y, z]: [f64; 3]) -> f64 {
        let combined = |excess: &[f64]| {
            let outside = excess.iter().map(|it| it.max(0.0).powi(2)).sum::<f64>();
            let inside = excess.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            outside.sqrt() + inside.min(0.0)
        };
        match *self {
            Interior::Ball { radius, height } => {
                let z = z - height;
                (x * x + y * y + z * z).sqrt() - radius
            }
            Interior::Box { half, low, high } => {
                let vertical = (low - z).max(z - high);
                combined(&[x.abs() - half[0], y.abs() - half[1], vertical])
            }
            Interior::Cylinder { radius, low, high } => {
                let vertical = (low - z).max(z - high);
                combined(&[x.hypot(y) - radius, vertical])
            }
        }
    }

    /// Returns the region without the points that are nearer than `margin` to its surface.
    pub fn shrunk(self, margin: f64) -> Interior {
        match self {
            Interior::Ball { radius, height } => Interior::Ball {
                radius: radius - margin,
                height,
            },
            Interior::Box { half, low, high } => Interior::Box {
                half: half.map(|half| half - margin),
                low: low + margin,
                high: high - margin,
            },
            Interior::Cylinder { radius, low, high } => Interior::Cylinder {
                radius: radius - margin,
                low: low + margin,
                high: high - margin,
            },
        }
    }

    /// Returns the region without a lower wall, for scenes whose ground is solid.
    pub fn on_solid_ground(mut self) -> Interior {
        if let Interior::Box { low, .. } | Interior::Cylinder { low, .. } = &mut self {
            *low = f64::NEG_INFINITY;
        }
        self
    }

    /// Returns an upper bound of every coordinate of a point inside.
    pub fn reach(&self) -> f64 {
        match *self {
            Interior::Ball { radius, height } => radius + height,
            Interior::Box { half, high, .. } => half[0].max(half[1]).max(high),
            Interior::Cylinder { radius, high, .. } => radius.max(high),
        }
    }

    /// Returns the height of rings and jets: half the height of the enclosure, or the centre of a
    /// sphere.
    pub fn halfway(&self) -> f64 {
        match *self {
            Interior::Ball {
                radius,
                height: 0.0,
            } => radius / 2.0,
            Interior::Ball { height, .. } => height,
            Interior::Box { low, high, .. } | Interior::Cylinder { low, high, .. } => {
                (high + low) / 2.0
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNITS: BlockUnits = BlockUnits {
        side: 0.5,
        mass: 1.0,
        tick: 1.0,
    };

    const PLATE: Plate = Plate { width: 3, depth: 3 };

    fn enclosures() -> [Enclosure; 5] {
        let wall = 1.0;
        let [radius, height, length, width] = [4.0, 3.0, 6.0, 5.0];
        [
            Enclosure::Hemisphere { radius, wall },
            Enclosure::Sphere { radius, wall },
            Enclosure::Box {
                length,
                width,
                height,
                wall,
            },
            Enclosure::Cylinder {
                radius,
                height,
                wall,
            },
            Enclosure::Cylinder {
                radius,
                height: 0.8,
                wall,
            },
        ]
    }

    /// Returns points that fill a cube around the origin evenly, by an additive recurrence.
    fn points(half: f64, count: u32) -> impl Iterator<Item = [f64; 3]> {
        let steps = [0.8191725134, 0.6710436067, 0.5497004779];
        (1..=count)
            .map(move |n| steps.map(|step| half * (2.0 * (f64::from(n) * step).fract() - 1.0)))
    }

    /// Compares the volume where the distance is negative with the volume of the same enclosure
    /// whose walls are half a block nearer.
    #[test]
    fn volumes_agree_with_the_signed_distance() {
        let half_block = UNITS.side / 2.0;
        for enclosure in enclosures() {
            let interior = enclosure.interior(&PLATE, UNITS);
            let half = 1.01 * interior.reach();
            let count = 2_000_000;
            let inside = points(half, count).filter(|point| interior.distance(*point) < 0.0);
            let part = inside.count() as f64 / f64::from(count);
            let found = part * (2.0 * half * UNITS.side).powi(3);
            let mut smaller = enclosure.clone();
            for (name, length) in smaller.lengths_mut() {
                *length -= if name == "radius" {
                    half_block
                } else {
                    2.0 * half_block
                };
            }
            let expected = match enclosure {
                // Without solid ground, the wall is a whole ball. It acts on centres.
                Enclosure::Hemisphere { .. } => 2.0 * enclosure.volume(),
                _ => smaller.volume(),
            };
            assert!(
                (found / expected - 1.0).abs() < 0.004,
                "{enclosure:?}: {found} {expected}"
            );
        }
    }

    /// A signed distance never changes faster than the position, and changes as fast along its
    /// gradient.
    #[test]
    fn distances_have_slope_one() {
        for enclosure in enclosures() {
            let interior = enclosure.interior(&PLATE, UNITS);
            let mut corners = 0;
            for point in points(2.0 * interior.reach(), 5_000) {
                let h = 1e-6;
                let slope = [0, 1, 2].map(|axis| {
                    let at = |shift: f64| {
                        let mut position = point;
                        position[axis] += shift;
                        interior.distance(position)
                    };
                    (at(h) - at(-h)) / (2.0 * h)
                });
                let norm = slope.iter().map(|it| it * it).sum::<f64>().sqrt();
                // On the planes of symmetry, the gradient jumps.
                corners += u32::from((norm - 1.0).abs() > 1e-6);
                assert!(norm < 1.0 + 1e-6, "{enclosure:?} {point:?}: {norm}");
            }
            assert!(corners < 5, "{enclosure:?}: {corners}");
        }
    }

    #[test]
    fn a_block_is_outside_if_a_corner_is() {
        for enclosure in enclosures() {
            // Walls that act on points, in block lengths.
            let shrunk = match enclosure {
                Enclosure::Hemisphere { .. } => 0.0,
                _ => -0.5,
            };
            let walls = enclosure.interior(&PLATE, UNITS).shrunk(shrunk);
            for (x, y, z) in
                (0..11).flat_map(|x| (0..13).flat_map(move |y| (1..15).map(move |z| (x, y, z))))
            {
                let cell = Cell::new(x, y, z);
                let corner = |n: i32, at: i32, shift: f64| f64::from(at) + f64::from(n) - shift;
                let farthest = (0..8).map(|n| {
                    let z = corner(n >> 2, z, 1.0);
                    walls.distance([corner(n & 1, x, 1.5), corner(n >> 1 & 1, y, 1.5), z])
                });
                let farthest = farthest.fold(f64::NEG_INFINITY, f64::max);
                let extents = enclosure.extents(cell, &PLATE, UNITS.side);
                let is_outside = extents.iter().any(Extent::is_outside);
                if farthest.abs() > 1e-9 {
                    assert_eq!(
                        is_outside,
                        farthest > 0.0,
                        "{enclosure:?} {cell}: {farthest}"
                    );
                }
            }
        }
    }
}
