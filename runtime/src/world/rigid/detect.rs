//! Who touches whom at the beginning of a substep.
use nalgebra::Vector3;
use smallvec::SmallVec;
use stochc_ir::table::Plate;

use super::bodies::Bodies;
use super::grid::TOUCH;
use super::kernel::{Contacts, Kernel};
use super::lanes::{ABREAST, Lane};
use super::overlap::{Cuboid, Patch, ball_on_ground, balls, boxes, cube_on_ground};
use crate::world::free_bonds::FreeBonds;
use crate::world::real::Real;
use crate::world::terms::built;

/// What blocks and ground look like to each other.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape<R: Real> {
    spheres: bool,
    ground: Ground<R>,
}

#[derive(Clone, Copy, Debug)]
enum Ground<R: Real> {
    /// The plane z = 0, level with the plate.
    Plane,
    /// Nothing but the plate.
    Plate(Cuboid<R>),
}

impl<R: Lane> Shape<R> {
    /// Without an enclosure there is no floor.
    pub fn new(floor: bool, plate: &Plate, spheres: bool) -> Shape<R> {
        let half = |blocks: u32| R::of(f64::from(blocks) / 2.0);
        let ground = if floor {
            Ground::Plane
        } else {
            Ground::Plate(Cuboid {
                centre: Vector3::z() * R::of(-0.5),
                axes: nalgebra::Rotation3::identity(),
                half: Vector3::new(half(plate.width), half(plate.depth), R::of(0.5)),
            })
        };
        Shape { spheres, ground }
    }

    /// Leaves out blocks, low enough for it, that cannot touch the ground.
    fn keep_near_ground(&self, bodies: &Bodies<R>, low: &mut Vec<u32>) {
        if let Ground::Plate(plate) = &self.ground {
            low.retain(|&id| {
                let way = (bodies.centre(id as usize) - plate.centre).abs() - plate.half;
                way.max() < R::of(TOUCH / 2.0)
            });
        }
    }

    /// How block `i` and the ground overlap.
    fn on_ground(&self, bodies: &Bodies<R>, i: usize) -> Option<Patch<R>> {
        match &self.ground {
            Ground::Plane if self.spheres => ball_on_ground(bodies.centre(i)),
            Ground::Plane => cube_on_ground(bodies.centre(i), bodies.axes(i)),
            // A ball on an edge of the plate is a rare thing that is not worth a rule of its own.
            Ground::Plate(plate) => boxes(&[(cube(bodies, i), *plate)]).next().flatten(),
        }
    }

    /// Whether it matters how blocks are turned that touch the ground, and those that touch each other.
    fn has_edges(&self) -> [bool; 2] {
        let balls_only = self.spheres && matches!(self.ground, Ground::Plane);
        [!balls_only, !self.spheres]
    }
}

/// A block.
fn cube<R: Lane>(bodies: &Bodies<R>, id: usize) -> Cuboid<R> {
    Cuboid::cube(bodies.centre(id), *bodies.axes(id))
}

impl<R: Lane> Kernel<R> {
    /// Finds all contacts, in an order that depends on nothing but the blocks' numbers.
    pub(super) fn detect(&mut self) {
        let (true, Some(contacts), Some(neighbours)) =
            (built::CONTACT, &mut self.contacts, &mut self.neighbours)
        else {
            return;
        };
        let bodies = &mut self.bodies;
        let Contacts {
            shape,
            solver,
            mutual,
            low,
            close,
        } = contacts;
        solver.clear();
        bodies.list_below(R::of(TOUCH / 2.0), low);
        shape.keep_near_ground(bodies, low);
        neighbours.close_pairs(bodies, close);
        close.retain(|&(a, b)| {
            let apart = |bonds: &FreeBonds| !bonds.groups.same(a, b);
            let free = [a, b].map(|id| bodies.is_free(id as usize));
            free != [false, false]
                && (free != [true, true] || *mutual)
                && self.free_bonds.as_ref().is_none_or(apart)
        });
        let [on_ground, mutually] = shape.has_edges();
        bodies.show(low.iter().copied().filter(|_| on_ground));
        bodies.show(close.iter().flat_map(|&(a, b)| [a, b]).filter(|_| mutually));
        for &id in &*low {
            if let Some(patch) = shape.on_ground(bodies, id as usize) {
                solver.add(bodies, id, None, &patch);
            }
        }
        for pairs in close.chunks(ABREAST) {
            let mut add = |(a, b): (u32, u32), patch: Option<Patch<R>>| {
                if let Some(patch) = patch {
                    solver.add(bodies, a, Some(b), &patch);
                }
            };
            if shape.spheres {
                for &(a, b) in pairs {
                    let patch = balls(bodies.centre(a as usize), bodies.centre(b as usize));
                    add((a, b), patch);
                }
            } else {
                let cubes: SmallVec<[_; ABREAST]> = (pairs.iter())
                    .map(|&(a, b)| (cube(bodies, a as usize), cube(bodies, b as usize)))
                    .collect();
                for (&pair, patch) in pairs.iter().zip(boxes(&cubes)) {
                    add(pair, patch);
                }
            }
        }
    }
}
