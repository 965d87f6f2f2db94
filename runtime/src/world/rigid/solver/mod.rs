//! Contacts: which there are, and the impulses that keep them (sequential impulses, Catto 2005).
//!
//! A rigid contact is solved twice: for velocities, with restitution and Coulomb's friction, and
//! for the overlap that the time step has let through, by a motion that leaves no velocity behind.
//! A compliant one is a spring and a damper, taken implicitly. Most bodies touch one thing only:
//! such contacts are solved side by side, and all others one after the other, by the same
//! arithmetic.
mod chain;
mod law;
mod motion;
mod pair;
mod touch;

use chain::Chains;
use law::{FASTEST, Law, PRECISION};
use motion::{GROUND, Moving};
use nalgebra::Vector3;
use pair::Abreast;
use touch::Touches;

use super::bodies::Bodies;
use super::lanes::{Lane, Quad};
use super::overlap::Patch;
use crate::world::terms::Contact;

/// Finds the impulses of all contacts of a substep.
#[derive(Clone, Debug)]
pub(super) struct Solver<R: Lane> {
    law: Law<R>,
    iterations: u32,
    touches: Touches<R>,
    moving: Moving<R>,
    /// The contacts that share no body with another: with something that does not move, and of two.
    single: Abreast<R, 1>,
    double: Abreast<R, 2>,
    chains: Chains<R>,
}

impl<R: Lane> Solver<R> {
    /// `turns`: whether contacts can turn blocks at all.
    pub fn new(contact: &Contact, count: usize, iterations: u32, turns: bool) -> Solver<R> {
        Solver {
            law: Law::new(contact),
            iterations: iterations.max(1),
            touches: Touches::new(),
            moving: Moving::new(count, turns),
            single: Abreast::new(),
            double: Abreast::new(),
            chains: Chains::new(),
        }
    }

    /// Forgets all contacts.
    pub fn clear(&mut self) {
        self.moving.clear();
        self.touches.clear();
    }

    /// Adds the contact of block `a` with block `b`, or with something that never moves.
    pub fn add(&mut self, bodies: &Bodies<R>, a: u32, b: Option<u32>, patch: &Patch<R>) {
        let places = [Some(a), b].map(|id| match id {
            Some(id) if bodies.is_free(id as usize) => self.moving.place(id),
            _ => GROUND,
        });
        let centres = [Some(a), b].map(|id| id.map(|id| bodies.centre(id as usize)));
        self.touches.add(places, centres, patch);
    }

    /// Solves all contacts, whose bodies have been moved with the velocities that they would have
    /// without: changes the velocities, and moves the bodies by the difference.
    ///
    /// `late` is half of what the shell has done to a block at a place: in the middle of a step its
    /// velocity was that much less far. A collision at another velocity than that would add to the
    /// energy of all blocks that meet in the shell. `moved` is told of every block whose motion has
    /// changed.
    pub fn solve(
        &mut self,
        bodies: &mut Bodies<R>,
        late: impl Fn(Vector3<R>) -> Vector3<R>,
        mut moved: impl FnMut(&Bodies<R>, usize),
    ) {
        if self.touches.list.is_empty() {
            return;
        }
        self.moving.start(|i| {
            let velocity = bodies.velocity(i);
            let place = bodies.centre(i) - velocity * bodies.dt;
            (velocity - late(place), bodies.spin[i])
        });
        self.find_impulses(bodies.dt);
        let dt = bodies.dt;
        let rigid = self.law.restitution().is_some();
        for (i, change) in self.moving.changes() {
            let way = change.velocity + change.shift.velocity.unpack();
            bodies.set_centre(i, bodies.centre(i) + way * dt);
            bodies.set_velocity(i, bodies.velocity(i) + change.velocity);
            if rigid {
                bodies.turn_now(i, change.shift.spin.unpack() * dt);
            } else {
                // What it is turned by now, it was turned to before its spin changes.
                bodies.rotation_now(i);
            }
            bodies.spin[i] = change.spin;
            moved(bodies, i);
        }
    }

    /// Solves all contacts for the motions of their bodies.
    fn find_impulses(&mut self, dt: R) {
        let (law, rounds) = (&self.law, self.iterations);
        let (touches, moving) = (&self.touches, &mut self.moving);
        self.single.clear();
        self.double.clear();
        self.chains.clear();
        let mut fastest = R::zero();
        for (number, touch) in touches.list.iter().enumerate() {
            if !moving.is_alone(touch.bodies) {
                let approach = (self.chains).add(touches, touch, &moving.motions, law, dt);
                fastest = fastest.max(approach);
            } else if touch.bodies[1] == GROUND {
                self.single.add(number);
            } else {
                self.double.add(number);
            }
        }
        let single = self.single.load(touches, moving, law, dt);
        let double = self.double.load(touches, moving, law, dt);
        let tolerance = fastest.max(single).max(double) * R::of(PRECISION);
        self.single.push(law, rounds, tolerance, moving.inertia());
        self.double.push(law, rounds, tolerance, moving.inertia());
        self.chains.push(moving, law, rounds, tolerance);
        if law.restitution().is_some() {
            let tolerance = R::of(FASTEST * PRECISION);
            self.single.part(rounds, tolerance);
            self.double.part(rounds, tolerance);
            self.chains.part(moving, rounds, tolerance);
        }
        self.single.store(moving);
        self.double.store(moving);
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;
    use stochc_ir::scene::ContactLaw;

    use super::*;
    use crate::world::BodyState;
    use crate::world::rigid::overlap::Point;

    const BLOCKS: u32 = 41;

    /// What becomes of blocks that hit the ground or another block, all at once, at random points;
    /// solved side by side, or one after the other.
    fn collide(contact: &Contact, side_by_side: bool) -> Vec<[Vector3<f32>; 4]> {
        let mut dice = ChaCha8Rng::seed_from_u64(1);
        let mut vector = |size: f32| Vector3::from_fn(|_, _| dice.random_range(-size..size));
        let blocks: Vec<BodyState> = (0..BLOCKS)
            .map(|i| BodyState {
                velocity: vector(0.3).map(f64::from),
                spin: vector(0.3).map(f64::from),
                ..BodyState::at_rest(Vector3::x() * f64::from(i))
            })
            .collect();
        let bodies = Bodies::<f32>::new(&blocks, 0.5);
        let mut solver = Solver::new(contact, blocks.len(), 50, true);
        solver.clear();
        // By rounding, a corner that is below the ground may seem to be level with it.
        let least = match contact.law {
            ContactLaw::Rigid { .. } => 0.0,
            ContactLaw::Compliant { .. } => 0.01,
        };
        let mut id = 0;
        while id + 1 < BLOCKS {
            let single = id % 5 < 2;
            let middle = bodies.centre(id as usize) + vector(0.5);
            let points = (0..=id % 4).map(|n| Point {
                place: middle + vector(0.5),
                depth: least + 0.01 * n as f32,
            });
            let points = points.collect();
            let normal = vector(1.0).normalize();
            let patch = Patch { normal, points };
            solver.add(&bodies, id, (!single).then_some(id + 1), &patch);
            id += if single { 1 } else { 2 };
        }
        let moving = &mut solver.moving;
        moving.start(|i| (bodies.velocity(i), bodies.spin[i]));
        if !side_by_side {
            moving.entangle();
        }
        solver.find_impulses(bodies.dt);
        let alone = solver.moving.changes();
        let found = alone.map(|(_, change)| {
            let shift = change.shift;
            let shift = [shift.velocity.unpack(), shift.spin.unpack()];
            [change.velocity, change.spin, shift[0], shift[1]]
        });
        found.collect()
    }

    #[test]
    fn contacts_side_by_side_are_solved_like_others() {
        let rigid = |restitution| ContactLaw::Rigid { restitution };
        let compliant = ContactLaw::Compliant {
            stiffness: 0.8,
            damping: 0.3,
        };
        for law in [rigid(0.0), rigid(0.7), compliant] {
            for friction in [0.0, 0.2, 3.0] {
                let contact = Contact {
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
