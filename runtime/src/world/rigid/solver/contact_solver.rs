//! Solves the contacts of a step.
use nalgebra::{UnitQuaternion, Vector3};

use super::centre_of_pressure::centre_of_pressure;
use super::contact_law::{FASTEST, Law, PRECISION};
use super::contact_list::ContactList;
use super::parallel::ParallelContacts;
use super::sequential::SequentialContacts;
use super::solver_bodies::{GROUND, SolverBodies};
use crate::world::blocks::Blocks as _;
use crate::world::rigid::bodies::Bodies;
use crate::world::rigid::narrow_phase::Manifold;
use crate::world::rigid::simd::Lane;

/// Solver of all contacts of a substep.
#[derive(Clone, Debug)]
pub(crate) struct Solver<R: Lane> {
    pub(super) law: Law<R>,
    iterations: u32,
    pub(super) touches: ContactList<R>,
    pub(super) moving: SolverBodies<R>,
    /// Contacts of a block with an immovable body. The block has no other contact.
    single: ParallelContacts<R, 1>,
    /// Contacts of two blocks. Neither of them has another contact.
    double: ParallelContacts<R, 2>,
    /// All other contacts.
    chains: SequentialContacts<R>,
}

impl<R: Lane> Solver<R> {
    /// Returns a solver without contacts. `turns` states whether contacts can rotate blocks.
    pub fn new(law: Law<R>, count: usize, iterations: u32, turns: bool) -> Solver<R> {
        Solver {
            law,
            iterations: iterations.max(1),
            touches: ContactList::default(),
            moving: SolverBodies::new(count, turns),
            single: ParallelContacts::default(),
            double: ParallelContacts::default(),
            chains: SequentialContacts::default(),
        }
    }

    pub fn clear(&mut self) {
        self.moving.clear();
        self.touches.clear();
    }

    /// Adds the contact of block `a` with block `b` or an immovable body.
    pub fn add(&mut self, bodies: &Bodies<R>, a: u32, b: Option<u32>, manifold: &Manifold<R>) {
        let indices = [Some(a), b].map(|id| match id {
            Some(id) if bodies.is_free(id) => self.moving.add_contact(id),
            _ => GROUND,
        });
        let span = bodies.span_of_pair([a, b.unwrap_or(a)]);
        let centres = [Some(a), b].map(|id| id.map(|id| bodies.position(id)));
        if let Some(stiffness) = self.law.stiffness() {
            let moving = [0, 1].map(|i| centres[i].filter(|_| indices[i] != GROUND));
            let response = stiffness * span * span;
            let point = centre_of_pressure(manifold, moving, response);
            (self.touches).add(indices, centres, span, manifold.normal, &[point]);
        } else {
            (self.touches).add(indices, centres, span, manifold.normal, &manifold.points);
        }
    }

    /// Records the velocity change of a block by a force in this step.
    pub fn pushed(&mut self, id: u32, change: Vector3<R>) {
        if self.law.restitution().is_some() {
            self.moving.pushed(id, change);
        }
    }

    /// Solves all contacts after the bodies moved as if there were none. Changes the velocities and
    /// corrects the positions accordingly.
    ///
    /// `push` returns the acceleration that the wall gives a block at a position. If contacts are
    /// rigid, it includes the steady acceleration. Contacts act in the middle of a step, before the
    /// second half of the resulting velocity change. Otherwise collisions would add energy to
    /// blocks that fall or meet the wall. `moved` receives every changed block with its position,
    /// velocity, spin and rotation.
    pub fn solve(
        &mut self,
        bodies: &mut Bodies<R>,
        push: impl Fn(Vector3<R>) -> Vector3<R>,
        mut moved: impl FnMut(u32, [Vector3<R>; 3], &UnitQuaternion<R>),
    ) {
        if self.touches.list.is_empty() {
            return;
        }
        let rigid = self.law.restitution().is_some();
        self.moving.start(rigid, |id| {
            let velocity = bodies.velocity(id);
            let position = bodies.position(id) - velocity * bodies.step(id);
            let late = push(position) * (bodies.span(id) * R::from_double(0.5));
            [velocity, bodies.spin(id), late]
        });
        self.find_impulses();
        for (id, change) in self.moving.changes() {
            let dt = bodies.step(id);
            let [shift, turn] = change.shift;
            if rigid {
                bodies.turn_now(id, turn * dt);
            }
            let displacement = (change.velocity + shift) * dt;
            let (motion, rotation) = bodies.correct(id, displacement, change.velocity, change.spin);
            moved(id, motion, &rotation);
        }
    }

    fn find_impulses(&mut self) {
        let (law, rounds) = (&self.law, self.iterations);
        let (touches, moving) = (&self.touches, &mut self.moving);
        self.single.clear();
        self.double.clear();
        self.chains.clear();
        let mut fastest = R::zero();
        for (number, touch) in touches.list.iter().enumerate() {
            if !moving.is_alone(touch.bodies) {
                let approach = (self.chains).add(touches, touch, moving, law);
                fastest = fastest.max(approach);
            } else if touch.bodies[1] == GROUND {
                self.single.add(number);
            } else {
                self.double.add(number);
            }
        }
        let single = self.single.load(touches, moving, law);
        let double = self.double.load(touches, moving, law);
        let tolerance = fastest.max(single).max(double) * R::from_double(PRECISION);
        self.single.push(law, rounds, tolerance, moving.inertia());
        self.double.push(law, rounds, tolerance, moving.inertia());
        self.chains.push(moving, law, rounds, tolerance);
        if law.restitution().is_some_and(|part| part > R::zero()) {
            self.single.spare();
            self.double.spare();
            self.chains.spare(moving);
        }
        if law.restitution().is_some() {
            let tolerance = R::from_double(FASTEST * PRECISION);
            self.single.part(rounds, tolerance);
            self.double.part(rounds, tolerance);
            self.chains.part(moving, rounds, tolerance);
        }
        let rigid = law.restitution().is_some();
        self.single.store(moving, rigid);
        self.double.store(moving, rigid);
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;
    use stochc_ir::scene::ContactLaw;

    use super::*;
    use crate::world::BodyState;
    use crate::world::parameters::ContactParameters;
    use crate::world::rigid::narrow_phase::ManifoldPoint;

    const BLOCKS: u32 = 41;

    /// Returns the motions of blocks after simultaneous collisions with the ground or another block
    /// at random points. `side_by_side` solves the contacts in parallel, otherwise in sequence.
    fn collide(contact: &ContactParameters, side_by_side: bool) -> Vec<[Vector3<f32>; 4]> {
        let mut dice = ChaCha8Rng::seed_from_u64(1);
        let mut vector = |size: f32| Vector3::from_fn(|_, _| dice.random_range(-size..size));
        let blocks: Vec<BodyState> = (0..BLOCKS)
            .map(|i| BodyState {
                velocity: vector(0.3).map(f64::from),
                spin: vector(0.3).map(f64::from),
                ..BodyState::at_rest(Vector3::x() * f64::from(i))
            })
            .collect();
        let bodies = Bodies::<f32>::new(&blocks, 0.5, 0.5);
        let mut solver = Solver::new(Law::new(contact), blocks.len(), 50, true);
        solver.clear();
        // Because of rounding, a corner slightly below the ground may appear level with it.
        let least = match contact.law {
            ContactLaw::Rigid { .. } => 0.0,
            ContactLaw::Compliant { .. } => 0.01,
        };
        let mut id = 0;
        while id + 1 < BLOCKS {
            let single = id % 5 < 2;
            let middle = bodies.position(id) + vector(0.5);
            let points = (0..=id % 4).map(|n| ManifoldPoint {
                position: middle + vector(0.5),
                depth: least + 0.01 * n as f32,
            });
            let points = points.collect();
            let normal = vector(1.0).normalize();
            let manifold = Manifold {
                normal,
                points,
                slope: vector(0.3),
            };
            solver.add(&bodies, id, (!single).then_some(id + 1), &manifold);
            id += if single { 1 } else { 2 };
        }
        let moving = &mut solver.moving;
        moving.start(true, |id| {
            [bodies.velocity(id), bodies.spin(id), bodies.spin(id) * 0.3]
        });
        if !side_by_side {
            moving.entangle();
        }
        solver.find_impulses();
        let alone = solver.moving.changes();
        let found = alone.map(|(_, change)| {
            let shift = change.shift;
            [change.velocity, change.spin, shift[0], shift[1]]
        });
        found.collect()
    }

    #[test]
    fn adjacent_contacts_are_solved_like_others() {
        let rigid = |restitution| ContactLaw::Rigid { restitution };
        let compliant = ContactLaw::Compliant {
            stiffness: 0.8,
            damping: 0.3,
        };
        for law in [rigid(0.0), rigid(0.7), compliant] {
            for friction in [0.0, 0.2, 3.0] {
                let contact = ContactParameters {
                    law: law.clone(),
                    friction,
                };
                let together = collide(&contact, true);
                assert!(together.iter().any(|[velocity, ..]| velocity.norm() > 0.02));
                assert_eq!(together, collide(&contact, false), "{contact:?}");
            }
        }
    }
}
