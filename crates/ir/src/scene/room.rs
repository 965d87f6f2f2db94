//! Check whether the free blocks of a scene fit into its enclosure at tick 0.
use std::f64::consts::{SQRT_2, TAU};
use std::fmt;

use super::dimensionless::BlockUnits;
use super::{Arrangement, Interior, Scene};
use crate::Cell;
use crate::table::plate::Plate;

/// Smallest distance of a centre from the ground and from the wall \[block lengths\].
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

/// Distance of a centre from a wall that acts on the inscribed spheres of blocks, beyond half a
/// block length \[block lengths\]. The distance from the wall is then [`MARGIN`].
const GAP: f64 = MARGIN - 0.5;

/// Points of a lattice along one axis.
#[derive(Clone, Copy)]
struct Row {
    first: i64,
    end: i64,
    /// Position of point 0, divided by the spacing.
    offset: f64,
    spacing: f64,
}

impl Row {
    /// Returns the points between `first` and `end`, half a spacing away from 0.
    fn around_zero(first: i64, end: i64, spacing: f64) -> Row {
        let offset = 0.5;
        Row {
            first,
            end,
            offset,
            spacing,
        }
    }

    /// Returns points that fill a length evenly, at least `spacing` apart, with 0 in the middle.
    fn filling(length: f64, spacing: f64) -> Row {
        let gaps = (length / spacing).min(1e9).floor();
        let offset = -gaps / 2.0;
        Row {
            first: 0,
            end: if length < 0.0 { 0 } else { gaps as i64 + 1 },
            offset,
            spacing: if gaps > 0.0 { length / gaps } else { 0.0 },
        }
    }

    fn at(self, step: i64) -> f64 {
        (step as f64 + self.offset) * self.spacing
    }

    fn steps(self) -> impl Iterator<Item = i64> {
        self.first..self.end
    }
}

impl Interior {
    /// Returns the lattice points in the region \[block lengths\], in the order of z, y, x. The
    /// lattice is symmetric about the vertical axis. In a ball it is cubic with this spacing. In a
    /// box or a cylinder, points have at least this spacing, and fill the height evenly.
    pub fn lattice(&self, spacing: f64) -> impl Iterator<Item = [f64; 3]> + use<> {
        let around = |radius: f64| {
            let reach = (radius / spacing) as i64 + 1;
            (reach, Row::around_zero(-reach, reach, spacing))
        };
        // Points are relative to the middle of the region.
        let (rows, radius, lowest, middle) = match *self {
            Interior::Ball { radius, height } => {
                let (radius, low) = (radius - MARGIN, MARGIN - height);
                let (reach, row) = around(radius);
                let least = if low < 0.0 { -reach } else { 0 };
                let up = Row::around_zero(least, reach + 1, spacing);
                ([row, row, up], [radius, radius], low, height)
            }
            Interior::Box { half, low, high } => {
                let [x, y] = half.map(|half| Row::filling(2.0 * (half - GAP), spacing));
                let up = Row::filling(high - low - 2.0 * GAP, spacing);
                let none = f64::INFINITY;
                ([x, y, up], [none, none], -none, (low + high) / 2.0)
            }
            Interior::Cylinder { radius, low, high } => {
                let (_, row) = around(radius - GAP);
                let up = Row::filling(high - low - 2.0 * GAP, spacing);
                let (none, radius) = (f64::INFINITY, radius - GAP);
                ([row, row, up], [none, radius], -none, (low + high) / 2.0)
            }
        };
        let [x, y, z] = rows;
        let lines = z.steps().flat_map(move |k| y.steps().map(move |j| (j, k)));
        lines
            .flat_map(move |(j, k)| x.steps().map(move |i| [x.at(i), y.at(j), z.at(k)]))
            .filter(move |[_, _, z]| *z >= lowest)
            .filter(move |[x, y, z]| (x * x + y * y + z * z).sqrt() <= radius[0])
            .filter(move |[x, y, _]| (x * x + y * y).sqrt() <= radius[1])
            .map(move |[x, y, z]| [x, y, z + middle])
    }

    /// Returns `count` points on a horizontal circle at half height, evenly spaced \[block
    /// lengths\]. The first is in the east.
    pub fn ring(&self, radius: f64, count: u32) -> impl Iterator<Item = [f64; 3]> + use<> {
        let (height, angle) = (self.halfway(), TAU / f64::from(count));
        (0..count).map(move |i| {
            let (sin, cos) = libm::sincos(angle * f64::from(i));
            [radius * cos, radius * sin, height]
        })
    }

    /// Returns an upper bound of the spacing of lattices with more than one point \[block lengths\].
    pub fn largest_spacing(&self) -> f64 {
        match *self {
            Interior::Ball { radius, .. } => 2.0 * (radius - MARGIN) + 2.0,
            Interior::Box { half, low, high } => {
                2.0 * half[0].max(half[1]).max(high - low).max(MIN_SPACING)
            }
            Interior::Cylinder { radius, low, high } => {
                2.0 * radius.max(high - low).max(MIN_SPACING)
            }
        }
    }

    /// Checks whether blocks fit in this arrangement, apart from `obstacles`. `side` is the block
    /// length \[m\].
    ///
    /// # Errors
    ///
    /// If the blocks do not fit.
    pub fn has_room(
        &self,
        count: u32,
        arrangement: Arrangement,
        side: f64,
        obstacles: &Obstacles,
    ) -> Result<(), NoRoom> {
        match arrangement {
            Arrangement::Uniform => {
                // An obstacle takes up to nine points.
                if self.is_roomy(count.saturating_add(9 * obstacles.0.len() as u32)) {
                    return Ok(());
                }
                let points = obstacles.apart(self.lattice(MIN_SPACING));
                let points = points.take(count as usize);
                match points.count() as u32 {
                    fits if fits < count => Err(NoRoom::DoesNotFit { count, fits }),
                    _ => Ok(()),
                }
            }
            Arrangement::Ring { radius } => {
                let (radius, height) = (radius / side, self.halfway());
                let apart = 2.0 * radius * (TAU / f64::from(count) / 2.0).sin();
                let touches = count > 1 && apart < MIN_SPACING * SQRT_2;
                let is_outside = [[radius, 0.0, height], [0.0, radius, height]]
                    .into_iter()
                    .any(|position| self.distance(position) > 0.0);
                let is_blocked = || {
                    let obstacles = obstacles.0.first().map(|_| obstacles);
                    obstacles.is_some_and(|obstacles| {
                        obstacles.apart(self.ring(radius, count)).count() < count as usize
                    })
                };
                if touches || is_outside || is_blocked() || (height < MARGIN && !self.is_flat()) {
                    Err(NoRoom::OnRing { count })
                } else {
                    Ok(())
                }
            }
        }
    }

    /// Returns whether all blocks fit in a box within the region. If they do, the points need not be
    /// counted. Their number might exceed the memory.
    fn is_roomy(&self, count: u32) -> bool {
        let along = |length: f64| (length / MIN_SPACING - 1.0).max(0.0);
        let points = match *self {
            Interior::Ball { radius, .. } => {
                let radius = radius - MARGIN;
                along(radius).powi(2) * along(radius / 2.0 - MARGIN)
            }
            // Every point is in a box.
            Interior::Box { .. } => 0.0,
            Interior::Cylinder { radius, low, high } => {
                let layers = Row::filling(high - low - 2.0 * GAP, MIN_SPACING);
                along(SQRT_2 * (radius - GAP)).powi(2) * layers.end as f64
            }
        };
        points > f64::from(count)
    }
}

impl Scene {
    /// Checks whether the free blocks fit around a plate with these seeds.
    ///
    /// # Errors
    ///
    /// If the blocks do not fit.
    pub fn has_room(&self, plate: &Plate, seeds: &[Cell]) -> Result<(), NoRoom> {
        let count = self.free.count;
        if count == 0 {
            return Ok(());
        }
        let Some(enclosure) = &self.enclosure else {
            return Err(NoRoom::NoEnclosure { count });
        };
        let units = BlockUnits::from_scene(self);
        let interior = enclosure.interior(plate, units);
        let obstacles = Obstacles::new(self, plate, seeds);
        interior.has_room(count, self.free.arrangement, units.side, &obstacles)
    }
}

/// Horizontal positions of the seeds among the free blocks of a planar world \[block lengths\]. In
/// other worlds, the seeds are in the ground, and there are no obstacles.
#[derive(Clone, Debug, Default)]
pub struct Obstacles(Vec<[f64; 2]>);

impl Obstacles {
    /// Returns the seeds of a plate that are obstacles in a scene.
    pub fn new(scene: &Scene, plate: &Plate, seeds: &[Cell]) -> Obstacles {
        let centre = |edge: u32| (f64::from(edge) - 1.0) / 2.0;
        let middle = [centre(plate.width), centre(plate.depth)];
        let seeds = seeds.iter().filter(|_| scene.planar.is_some());
        let position = |cell: &Cell| [f64::from(cell.x) - middle[0], f64::from(cell.y) - middle[1]];
        Obstacles(seeds.map(position).collect())
    }

    /// Returns the points where an aligned block does not touch an obstacle.
    pub fn apart(&self, points: impl Iterator<Item = [f64; 3]>) -> impl Iterator<Item = [f64; 3]> {
        points.filter(|[x, y, _]| {
            let distance = |[u, v]: &[f64; 2]| (x - u).abs().max((y - v).abs());
            self.0.iter().all(|seed| distance(seed) >= MIN_SPACING)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lattices_keep_their_distance_from_each_other_and_from_walls() {
        let half = [6.0, 4.5];
        for (interior, gap) in [
            (
                Interior::Ball {
                    radius: 6.0,
                    height: 5.0,
                },
                MARGIN,
            ),
            (
                Interior::Box {
                    half,
                    low: 0.5,
                    high: 7.0,
                },
                GAP,
            ),
            (
                Interior::Box {
                    half,
                    low: 0.5,
                    high: 1.6,
                },
                GAP,
            ),
            (
                Interior::Cylinder {
                    radius: 5.0,
                    low: 0.5,
                    high: 9.0,
                },
                GAP,
            ),
            (
                Interior::Cylinder {
                    radius: 5.0,
                    low: 0.5,
                    high: 1.6,
                },
                GAP,
            ),
        ] {
            for spacing in [1.1, 1.3, 2.0] {
                let points: Vec<_> = interior.lattice(spacing).collect();
                assert!(points.len() > 3, "{interior:?} {spacing}");
                for (i, one) in points.iter().enumerate() {
                    assert!(interior.distance(*one) < 1e-9 - gap, "{interior:?} {one:?}");
                    for other in &points[..i] {
                        let apart = [0, 1, 2].map(|axis| one[axis] - other[axis]);
                        let apart = apart.iter().map(|it| it * it).sum::<f64>().sqrt();
                        assert!(apart > spacing - 1e-9, "{interior:?} {spacing}: {apart}");
                    }
                }
                for axis in [0, 1] {
                    let sum = points.iter().map(|step| step[axis]).sum::<f64>();
                    assert!(sum.abs() < 1e-9, "{interior:?}: {sum}");
                }
            }
        }
    }

    /// Checks that rooms of every size are filled without counting all of their points.
    #[test]
    fn small_and_large_rooms_are_filled() {
        let rooms = |size: f64, high: f64| {
            [
                Interior::Box {
                    half: [size; 2],
                    low: 0.5,
                    high,
                },
                Interior::Cylinder {
                    radius: size,
                    low: 0.5,
                    high,
                },
            ]
        };
        for size in [2.0, 3.0, 50.0, 1e9, 1e30] {
            for high in [1.5, 4.0, 1e9, 1e30] {
                for interior in rooms(size, high) {
                    let room =
                        interior.has_room(1, Arrangement::Uniform, 1.0, &Obstacles::default());
                    assert_eq!(room, Ok(()), "{interior:?}");
                }
            }
        }
        for interior in rooms(0.4, 4.0).into_iter().chain(rooms(4.0, 1.4)) {
            let room = interior.has_room(1, Arrangement::Uniform, 1.0, &Obstacles::default());
            let none = NoRoom::DoesNotFit { count: 1, fits: 0 };
            assert_eq!(room, Err(none), "{interior:?}");
        }
    }
}
