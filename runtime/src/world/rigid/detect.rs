//! Who touches whom at the beginning of a substep.
use nalgebra::Vector3;
use stochc_compiler::table::Plate;

use super::bodies::Bodies;
use super::grid::TOUCH;
use super::kernel::Kernel;
use super::lanes::Lane;
use super::overlap::{Cuboid, Patch, ball_on_ground, balls, boxes, cube_on_ground};
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

impl<R: Real> Shape<R> {
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

    fn cube(bodies: &mut Bodies<R>, i: usize) -> Cuboid<R> {
        let axes = *bodies.axes_now(i);
        Cuboid::cube(bodies.centre(i), axes)
    }

    /// How block `i` and the ground overlap.
    fn on_ground(&self, bodies: &mut Bodies<R>, i: usize) -> Option<Patch<R>> {
        match &self.ground {
            Ground::Plane if self.spheres => ball_on_ground(bodies.centre(i)),
            Ground::Plane => {
                let cube = Shape::cube(bodies, i);
                cube_on_ground(cube.centre, &cube.axes)
            }
            // A ball on an edge of the plate is a rare thing that is not worth a rule of its own.
            Ground::Plate(plate) => boxes(&Shape::cube(bodies, i), plate),
        }
    }

    /// How two blocks overlap.
    fn overlap(&self, bodies: &mut Bodies<R>, a: usize, b: usize) -> Option<Patch<R>> {
        if self.spheres {
            balls(bodies.centre(a), bodies.centre(b))
        } else {
            boxes(&Shape::cube(bodies, a), &Shape::cube(bodies, b))
        }
    }
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
        contacts.solver.clear();
        let low = R::of(TOUCH / 2.0);
        for i in 0..bodies.count() {
            if bodies.position[2][i] < low
                && bodies.is_free(i)
                && let Some(patch) = contacts.shape.on_ground(bodies, i)
            {
                contacts.solver.add(bodies, i as u32, None, &patch);
            }
        }
        neighbours.close_pairs(bodies, &mut contacts.close);
        for &(a, b) in &contacts.close {
            let (i, j) = (a as usize, b as usize);
            let free = (bodies.is_free(i), bodies.is_free(j));
            if free == (false, false) || (free == (true, true) && !contacts.mutual) {
                continue;
            }
            if let Some(bonds) = &self.free_bonds
                && bonds.groups.same(a, b)
            {
                continue;
            }
            if let Some(patch) = contacts.shape.overlap(bodies, i, j) {
                contacts.solver.add(bodies, a, Some(b), &patch);
            }
        }
    }
}
