//! Collision detection at the beginning of a substep.
use nalgebra::{Rotation3, Vector3};
use stochc_ir::table;

use super::bodies::Bodies;
use super::cell_list::TOUCH;
use super::local_steps::LocalSteps;
use super::narrow_phase::{
    Cuboid, Manifold, ball_on_ground, balls, boxes, cube_on_ground, face_on_ground, squares,
};
use super::neighbour_list::NeighbourList;
use super::simd::{ABREAST, Lane, filled};
use super::solver::{Law, Solver};
use crate::settings::{ROUNDS, Reduction, Settings};
use crate::world::blocks::Blocks;
use crate::world::free_bonds::FreeBonds;
use crate::world::parameters::{ContactParameters, WorldParameters};
use crate::world::real::Real;

#[derive(Clone, Copy, Debug)]
pub(super) struct CollisionShape<R: Real> {
    spheres: bool,
    /// Whether a contact acts at one point of its patch instead of all corners.
    compliant: bool,
    ground: Ground<R>,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Ground<R: Real> {
    /// The plane z = 0, level with the plate.
    Plane,
    /// Only the plate.
    Plate(PlateBox<R>),
    /// Table of a planar world, which no block leaves. Blocks are squares.
    Table,
}

/// Box around all seeds.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlateBox<R: Real> {
    centre: Vector3<R>,
    axes: Rotation3<R>,
    half: Vector3<R>,
}

impl<R: Real> Ground<R> {
    /// Returns the ground of a scene. Without an enclosure, there is no floor.
    pub fn new(parameters: &WorldParameters, plate: &table::Plate) -> Ground<R> {
        let half = |blocks: u32| R::from_double(f64::from(blocks) / 2.0);
        if parameters.is_planar {
            Ground::Table
        } else if parameters.wall.is_some() {
            Ground::Plane
        } else {
            Ground::Plate(PlateBox {
                centre: Vector3::z() * R::from_double(-0.5),
                axes: Rotation3::identity(),
                half: Vector3::new(half(plate.width), half(plate.depth), R::from_double(0.5)),
            })
        }
    }
}

impl<R: Lane> CollisionShape<R> {
    /// Removes blocks that cannot touch the ground from the list `low` of low blocks.
    fn keep_near_ground(&self, bodies: &Bodies<R>, low: &mut Vec<u32>) {
        if let Ground::Plate(plate) = &self.ground {
            low.retain(|&id| {
                let offset = (bodies.position(id) - plate.centre).abs() - plate.half;
                offset.max() < R::from_double(TOUCH / 2.0)
            });
        }
    }

    /// Calls `touch` with the contact between a block and the ground, if they overlap.
    fn on_ground(&self, bodies: &Bodies<R>, id: u32, mut touch: impl FnMut(&Manifold<R>)) {
        let position = bodies.position(id);
        let on_plane = match &self.ground {
            Ground::Plane if self.spheres => ball_on_ground(position),
            Ground::Plane if self.compliant => face_on_ground(position, bodies.axes(id)),
            Ground::Plane => cube_on_ground(position, bodies.axes(id)),
            Ground::Table => None,
            // A sphere at an edge of the plate is rare. It is treated as a cube.
            Ground::Plate(PlateBox { centre, axes, half }) => {
                let (centre, half) = (*centre, *half);
                let pair = (cube(bodies, id), Cuboid { centre, axes, half });
                boxes(&[pair; ABREAST], 1, |_, manifold| touch(manifold));
                return;
            }
        };
        on_plane.iter().for_each(touch);
    }

    /// Returns whether rotations affect contacts with the ground, and whether they affect contacts
    /// between blocks.
    fn has_edges(&self) -> [bool; 2] {
        let balls_only = self.spheres && !matches!(self.ground, Ground::Plate(_));
        [!balls_only, !self.spheres]
    }
}

fn cube<R: Lane>(bodies: &Bodies<R>, id: u32) -> Cuboid<'_, R> {
    Cuboid::cube(bodies.position(id), bodies.axes(id))
}

/// Collision detection and the contacts found.
#[derive(Clone, Debug)]
pub(super) struct Contacts<R: Lane> {
    shape: CollisionShape<R>,
    pub solver: Solver<R>,
    /// Whether free blocks collide with each other.
    mutual: bool,
    /// Buffer of the blocks near the ground.
    low: Vec<u32>,
    /// Buffer of the pairs of nearby blocks.
    close: Vec<(u32, u32)>,
    /// Buffer of the free blocks near seeds, each with the number of the seed.
    beside: Vec<(u32, usize)>,
}

impl<R: Lane> Contacts<R> {
    pub fn new(
        contact: &ContactParameters,
        ground: Ground<R>,
        settings: &Settings,
        count: usize,
    ) -> Contacts<R> {
        let without = |reduction| settings.reduction == Some(reduction);
        let law = Law {
            friction: if without(Reduction::Friction) {
                R::zero()
            } else {
                R::from_double(contact.friction)
            },
            ..Law::new(contact)
        };
        let turns = !without(Reduction::Rotation);
        let rounds = settings.solver_iterations.unwrap_or(ROUNDS);
        Contacts {
            shape: CollisionShape {
                spheres: without(Reduction::Corners),
                compliant: law.restitution().is_none(),
                ground,
            },
            solver: Solver::new(law, count, rounds, turns),
            mutual: !without(Reduction::BlockContact),
            low: Vec::new(),
            close: Vec::new(),
            beside: Vec::new(),
        }
    }

    /// Finds all contacts, in an order that depends only on block numbers.
    pub fn find(
        &mut self,
        bodies: &mut Bodies<R>,
        neighbours: &mut NeighbourList<R>,
        bonds: Option<&FreeBonds>,
        seeds: &[Vector3<R>],
    ) {
        let touch = R::from_double(TOUCH);
        self.list_near_fixed(
            seeds,
            |&seed, found| neighbours.around(seed, touch, found),
            |found| bodies.list_below(R::from_double(TOUCH / 2.0), found),
        );
        neighbours.close_pairs(bodies, &mut self.close);
        self.find_among(bodies, bonds, seeds);
    }

    /// Finds the contacts of the blocks with short steps, between two long steps.
    pub fn find_short(
        &mut self,
        bodies: &mut Bodies<R>,
        local: &LocalSteps<R>,
        seeds: &[Vector3<R>],
    ) {
        let (height, touch) = (R::from_double(TOUCH / 2.0), R::from_double(TOUCH * TOUCH));
        let low = |&id: &u32| bodies.is_free(id) && bodies.position(id).z < height;
        self.list_near_fixed(
            seeds,
            |_, found| found.clone_from(&local.blocks),
            |found| {
                found.clear();
                found.extend(local.blocks.iter().copied().filter(low));
            },
        );
        self.close.clear();
        let near =
            |&(a, b): &(u32, u32)| (bodies.position(a) - bodies.position(b)).norm_squared() < touch;
        self.close.extend(local.pairs.iter().copied().filter(near));
        self.find_among(bodies, None, seeds);
    }

    /// Lists the blocks near seeds or near the ground. `around` selects blocks that may touch a
    /// seed, and `below` blocks that may touch the ground.
    fn list_near_fixed(
        &mut self,
        seeds: &[Vector3<R>],
        mut around: impl FnMut(&Vector3<R>, &mut Vec<u32>),
        below: impl FnOnce(&mut Vec<u32>),
    ) {
        self.beside.clear();
        if !matches!(self.shape.ground, Ground::Table) {
            below(&mut self.low);
            return;
        }
        for (number, seed) in seeds.iter().enumerate() {
            around(seed, &mut self.low);
            (self.beside).extend(self.low.iter().map(|&id| (id, number)));
        }
        self.low.clear();
    }

    /// Finds the contacts among the candidate pairs, low blocks and blocks near seeds.
    fn find_among(
        &mut self,
        bodies: &mut Bodies<R>,
        bonds: Option<&FreeBonds>,
        seeds: &[Vector3<R>],
    ) {
        let Contacts {
            shape,
            solver,
            mutual,
            low,
            close,
            beside,
        } = self;
        solver.clear();
        shape.keep_near_ground(bodies, low);
        close.retain(|&(a, b)| {
            let free = [a, b].map(|id| bodies.is_free(id));
            free != [false, false]
                && (free != [true, true] || *mutual)
                && bonds.is_none_or(|bonds| !bonds.groups.same(a, b))
        });
        let [on_ground, mutually] = shape.has_edges();
        let low_ones = low.iter().copied().filter(|_| on_ground);
        let close_ones = close.iter().flat_map(|&(a, b)| [a, b]);
        let touch = R::from_double(TOUCH * TOUCH);
        beside.retain(|&(id, seed)| {
            bodies.is_free(id) && (bodies.position(id) - seeds[seed]).norm_squared() < touch
        });
        let beside_ones = beside.iter().map(|&(id, _)| id);
        let turned = close_ones.chain(beside_ones).filter(|_| mutually);
        bodies.show(low_ones.chain(turned));
        for &id in &*low {
            shape.on_ground(bodies, id, |manifold| {
                solver.add(bodies, id, None, manifold);
            });
        }
        let level = Rotation3::identity();
        for &(id, seed) in &*beside {
            let manifold = if shape.spheres {
                balls(bodies.position(id), seeds[seed])
            } else {
                squares(&cube(bodies, id), &Cuboid::cube(seeds[seed], &level))
            };
            if let Some(manifold) = manifold {
                solver.add(bodies, id, None, &manifold);
            }
        }
        let is_flat = matches!(shape.ground, Ground::Table);
        for pairs in close.chunks(ABREAST) {
            let mut add = |(a, b): (u32, u32), manifold: &Manifold<R>| {
                solver.add(bodies, a, Some(b), manifold);
            };
            if shape.spheres || is_flat {
                for &(a, b) in pairs {
                    let manifold = if shape.spheres {
                        balls(bodies.position(a), bodies.position(b))
                    } else {
                        squares(&cube(bodies, a), &cube(bodies, b))
                    };
                    manifold.iter().for_each(|manifold| add((a, b), manifold));
                }
            } else {
                let cubes = filled(pairs).map(|(a, b)| (cube(bodies, a), cube(bodies, b)));
                boxes(&cubes, pairs.len(), |nth, manifold| {
                    add(pairs[nth], manifold);
                });
            }
        }
    }
}
