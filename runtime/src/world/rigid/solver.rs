//! Contacts: which there are, and the impulses that keep them (sequential impulses, Catto 2005).
//!
//! A rigid contact is solved twice: for velocities, with restitution and Coulomb's friction, and
//! for the overlap that the time step has let through, by a motion that leaves no velocity behind.
//! A compliant one is a spring and a damper, taken implicitly. Contacts are visited again only as
//! long as one of their two bodies has changed since.
use nalgebra::Vector3;
use smallvec::SmallVec;
use stochc_compiler::scene::ContactLaw;

use super::bodies::Bodies;
use super::overlap::Patch;
use crate::world::magnet::INVERSE_INERTIA;
use crate::world::real::Real;
use crate::world::terms::Contact;

/// Part of an overlap that is undone in a substep.
const RECOVERY: f64 = 0.2;

/// Overlap that is left alone \[side\].
const SLOP: f64 = 0.001;

/// Fastest recovery from an overlap \[side / tick\].
const FASTEST: f64 = 0.1;

/// Changes of velocity below this part of the fastest approach are left alone.
const PRECISION: f64 = 1e-4;

/// What a contact does.
#[derive(Clone, Copy, Debug)]
struct Law<R> {
    friction: R,
    kind: Kind<R>,
}

#[derive(Clone, Copy, Debug)]
enum Kind<R> {
    Rigid {
        restitution: R,
    },
    /// Per depth \[1 / tick^2\] and per speed \[1 / tick\], for a block of mass 1.
    Compliant {
        stiffness: R,
        damping: R,
    },
}

/// Finds the impulses of all contacts of a substep.
#[derive(Clone, Debug)]
pub(super) struct Solver<R: Real> {
    law: Law<R>,
    inverse_inertia: R,
    iterations: u32,
    bodies: Vec<Moving<R>>,
    contacts: Vec<Touch<R>>,
    /// Index into `bodies` by number of a block, or [`NOBODY`].
    place: Vec<u32>,
}

const NOBODY: u32 = u32::MAX;

/// A block that touches something.
#[derive(Clone, Copy, Debug)]
struct Moving<R: Real> {
    id: u32,
    inverse_mass: R,
    inverse_inertia: R,
    velocity: Vector3<R>,
    spin: Vector3<R>,
    /// What undoes overlaps: moves the block in this substep and is forgotten.
    shift: Vector3<R>,
    tilt: Vector3<R>,
    /// When it was changed last, counted in visits.
    changed: u32,
}

/// Two bodies that touch, or one and the ground.
#[derive(Clone, Debug)]
struct Touch<R: Real> {
    a: usize,
    /// `None` is the ground, or something else that never moves.
    b: Option<usize>,
    points: SmallVec<[Spot<R>; 8]>,
    /// When it was visited last, in visits; whether it was content then.
    visited: u32,
    content: bool,
}

/// One point of a contact.
#[derive(Clone, Copy, Debug)]
struct Spot<R: Real> {
    /// From the centres of the two bodies.
    arms: [Vector3<R>; 2],
    /// How far the bodies overlap here.
    depth: R,
    /// Velocity along the normal that is asked for, or what a spring asks for.
    target: R,
    /// Of a compliant contact: how much an impulse softens the velocity.
    softness: R,
    /// Motion per tick that undoes the overlap.
    recovery: R,
    along: Row<R>,
    across: [Row<R>; 2],
    shift: R,
}

/// A direction at a point, in which the bodies can push each other.
#[derive(Clone, Copy, Debug)]
struct Row<R: Real> {
    direction: Vector3<R>,
    /// Torque of a unit impulse about the centres of the two bodies.
    torques: [Vector3<R>; 2],
    /// Impulse that changes the velocity here by one.
    mass: R,
    impulse: R,
}

impl<R: Real> Solver<R> {
    /// `turns`: whether contacts can turn blocks at all.
    pub fn new(contact: &Contact, count: usize, iterations: u32, turns: bool) -> Solver<R> {
        Solver {
            law: Law {
                friction: R::of(contact.friction),
                kind: match contact.law {
                    ContactLaw::Rigid { restitution } => Kind::Rigid {
                        restitution: R::of(restitution),
                    },
                    ContactLaw::Compliant { stiffness, damping } => Kind::Compliant {
                        stiffness: R::of(stiffness),
                        damping: R::of(damping),
                    },
                },
            },
            inverse_inertia: if turns {
                R::of(INVERSE_INERTIA)
            } else {
                R::zero()
            },
            iterations: iterations.max(1),
            bodies: Vec::new(),
            contacts: Vec::new(),
            place: vec![NOBODY; count],
        }
    }

    /// Forgets all contacts.
    pub fn clear(&mut self) {
        for body in &self.bodies {
            self.place[body.id as usize] = NOBODY;
        }
        self.bodies.clear();
        self.contacts.clear();
    }

    /// Adds the contact of block `a` with block `b`, or with something that never moves.
    pub fn add(&mut self, bodies: &Bodies<R>, a: u32, b: Option<u32>, patch: &Patch<R>) {
        let centre = |id: u32| bodies.centre(id as usize);
        let arm_of =
            |id: Option<u32>, place| id.map_or_else(Vector3::zeros, |id| place - centre(id));
        let (first, second) = (self.moving(bodies, a), b.map(|b| self.moving(bodies, b)));
        let normal = patch.normal;
        let across = if normal.x.abs() < R::of(0.7) {
            Vector3::x()
        } else {
            Vector3::y()
        };
        let one = normal.cross(&across).normalize();
        let tangents = [one, normal.cross(&one)];
        let points = patch.points.iter().map(|point| {
            let arms = [arm_of(Some(a), point.place), arm_of(b, point.place)];
            let row = |direction: Vector3<R>| Row {
                direction,
                torques: arms.map(|arm| arm.cross(&direction)),
                mass: R::zero(),
                impulse: R::zero(),
            };
            Spot {
                arms,
                depth: point.depth,
                target: R::zero(),
                softness: R::zero(),
                recovery: R::zero(),
                along: row(normal),
                across: tangents.map(row),
                shift: R::zero(),
            }
        });
        self.contacts.push(Touch {
            a: first,
            b: second,
            points: points.collect(),
            visited: 0,
            content: false,
        });
    }

    fn moving(&mut self, bodies: &Bodies<R>, id: u32) -> usize {
        let place = &mut self.place[id as usize];
        if *place == NOBODY {
            *place = self.bodies.len() as u32;
            let mobility = bodies.mobility[id as usize];
            self.bodies.push(Moving {
                id,
                inverse_mass: mobility,
                inverse_inertia: mobility * self.inverse_inertia,
                velocity: Vector3::zeros(),
                spin: Vector3::zeros(),
                shift: Vector3::zeros(),
                tilt: Vector3::zeros(),
                changed: 0,
            });
        }
        *place as usize
    }

    /// Solves all contacts, whose bodies have been moved with the velocities that they would have
    /// without: changes the velocities, and moves the bodies by the difference.
    ///
    /// `moved` is told of every block whose motion has changed.
    pub fn solve(&mut self, bodies: &mut Bodies<R>, mut moved: impl FnMut(&Bodies<R>, usize)) {
        if self.contacts.is_empty() {
            return;
        }
        for body in &mut self.bodies {
            body.velocity = bodies.velocity(body.id as usize);
            body.spin = bodies.spin[body.id as usize];
        }
        let mut fastest = R::zero();
        for contact in &mut self.contacts {
            fastest = fastest.max(contact.prepare(&self.bodies, &self.law, bodies.dt));
        }
        let tolerance = fastest * R::of(PRECISION);
        let friction = self.law.friction;
        self.repeat(|contact, bodies| contact.push(bodies, friction) > tolerance);
        if let Kind::Rigid { .. } = self.law.kind {
            let tolerance = R::of(FASTEST * PRECISION);
            self.repeat(|contact, bodies| contact.part(bodies) > tolerance);
        }
        let dt = bodies.dt;
        for body in &self.bodies {
            let i = body.id as usize;
            if bodies.is_free(i) {
                let change = body.velocity - bodies.velocity(i) + body.shift;
                bodies.set_centre(i, bodies.centre(i) + change * dt);
                bodies.set_velocity(i, body.velocity);
                bodies.turn_now(i, body.tilt * dt);
                bodies.spin[i] = body.spin;
                moved(bodies, i);
            }
        }
    }

    /// Visits contacts until none changes anything, or for as many rounds as are allowed.
    fn repeat(&mut self, visit: impl Fn(&mut Touch<R>, &mut [Moving<R>]) -> bool) {
        let mut visits = 0;
        for contact in &mut self.contacts {
            (contact.visited, contact.content) = (0, false);
        }
        for body in &mut self.bodies {
            body.changed = 0;
        }
        for _ in 0..self.iterations {
            let mut content = true;
            for contact in &mut self.contacts {
                let changed = |body: usize| self.bodies[body].changed;
                let last = changed(contact.a).max(contact.b.map_or(0, changed));
                if contact.content && last <= contact.visited {
                    continue;
                }
                visits += 1;
                let has_changed = visit(contact, &mut self.bodies);
                contact.content = !has_changed;
                contact.visited = visits;
                if has_changed {
                    content = false;
                    self.bodies[contact.a].changed = visits;
                    if let Some(b) = contact.b {
                        self.bodies[b].changed = visits;
                    }
                }
            }
            if content {
                break;
            }
        }
    }
}

impl<R: Real> Touch<R> {
    /// Works out what each point asks for; the fastest approach.
    fn prepare(&mut self, bodies: &[Moving<R>], law: &Law<R>, dt: R) -> R {
        let (a, b) = self.bodies(bodies);
        let mut fastest = R::zero();
        let (deepest, sum) = self
            .points
            .iter()
            .fold((R::zero(), R::zero()), |(most, sum), p| {
                (most.max(p.depth), sum + p.depth)
            });
        for point in &mut self.points {
            let velocity =
                |body: &Moving<R>, arm: &Vector3<R>| body.velocity + body.spin.cross(arm);
            let relative = velocity(&a, &point.arms[0]) - velocity(&b, &point.arms[1]);
            fastest = fastest.max(relative.norm_squared());
            match law.kind {
                Kind::Rigid { restitution } => {
                    let approach = relative.dot(&point.along.direction);
                    point.target = if approach < R::zero() {
                        -restitution * approach
                    } else {
                        R::zero()
                    };
                    let excess = (point.depth - R::of(SLOP)).max(R::zero());
                    point.recovery = (excess * R::of(RECOVERY) / dt).min(R::of(FASTEST));
                }
                Kind::Compliant { stiffness, damping } => {
                    // Together the points are as stiff as one at the deepest of them.
                    let share = deepest / sum;
                    let (stiffness, damping) = (stiffness * share, damping * share);
                    let firmness = dt * (damping + dt * stiffness);
                    point.softness = R::one() / firmness;
                    point.target = point.depth * stiffness * dt / firmness;
                }
            }
            point.along.weigh(&a, &b, point.softness);
            if law.friction > R::zero() {
                for across in &mut point.across {
                    across.weigh(&a, &b, R::zero());
                }
            }
        }
        fastest.sqrt()
    }

    /// Copies of the two bodies; something that never moves stands for the ground.
    #[inline(always)]
    fn bodies(&self, bodies: &[Moving<R>]) -> (Moving<R>, Moving<R>) {
        let ground = Moving {
            id: NOBODY,
            inverse_mass: R::zero(),
            inverse_inertia: R::zero(),
            velocity: Vector3::zeros(),
            spin: Vector3::zeros(),
            shift: Vector3::zeros(),
            tilt: Vector3::zeros(),
            changed: 0,
        };
        (bodies[self.a], self.b.map_or(ground, |b| bodies[b]))
    }

    /// Takes over what has become of the copies.
    #[inline(always)]
    fn settle(&self, bodies: &mut [Moving<R>], a: Moving<R>, b: Moving<R>) {
        bodies[self.a] = a;
        if let Some(index) = self.b {
            bodies[index] = b;
        }
    }

    /// One round of impulses; the greatest change of velocity at a point.
    fn push(&mut self, bodies: &mut [Moving<R>], friction: R) -> R {
        let mut greatest = R::zero();
        let (mut a, mut b) = self.bodies(bodies);
        for point in &mut self.points {
            if friction > R::zero() {
                // Coulomb's cone, of the impulse that presses now.
                let most = friction * point.along.impulse;
                let mut wanted = [R::zero(); 2];
                for (wanted, row) in wanted.iter_mut().zip(&point.across) {
                    *wanted = row.impulse - row.velocity(&a, &b) * row.mass;
                }
                let [one, two] = wanted;
                let square = one * one + two * two;
                if square > most * most {
                    let by = most / square.sqrt();
                    wanted = [one * by, two * by];
                }
                for (wanted, row) in wanted.into_iter().zip(&mut point.across) {
                    greatest = greatest.max(row.apply(wanted, &mut a, &mut b));
                }
            }
            let row = &mut point.along;
            let missing = point.target - row.velocity(&a, &b) - point.softness * row.impulse;
            let impulse = (row.impulse + missing * row.mass).max(R::zero());
            greatest = greatest.max(row.apply(impulse, &mut a, &mut b));
        }
        self.settle(bodies, a, b);
        greatest
    }

    /// One round of undoing overlaps; the greatest change of speed at a point.
    fn part(&mut self, bodies: &mut [Moving<R>]) -> R {
        let mut greatest = R::zero();
        let (mut a, mut b) = self.bodies(bodies);
        for point in &mut self.points {
            let row = &point.along;
            let relative = row.direction.dot(&(a.shift - b.shift)) + row.torques[0].dot(&a.tilt)
                - row.torques[1].dot(&b.tilt);
            let shift = (point.shift + (point.recovery - relative) * row.mass).max(R::zero());
            let change = shift - point.shift;
            point.shift = shift;
            a.shift += row.direction * (change * a.inverse_mass);
            a.tilt += row.torques[0] * (change * a.inverse_inertia);
            b.shift -= row.direction * (change * b.inverse_mass);
            b.tilt -= row.torques[1] * (change * b.inverse_inertia);
            greatest = greatest.max((change / row.mass).abs());
        }
        self.settle(bodies, a, b);
        greatest
    }
}

impl<R: Real> Row<R> {
    /// Works out the mass; `softness` is what an impulse softens the velocity by.
    fn weigh(&mut self, a: &Moving<R>, b: &Moving<R>, softness: R) {
        let yields = |body: &Moving<R>, torque: &Vector3<R>| {
            body.inverse_mass + body.inverse_inertia * torque.norm_squared()
        };
        let yielding = yields(a, &self.torques[0]) + yields(b, &self.torques[1]);
        self.mass = R::one() / (yielding + softness);
    }

    /// Of `a` as seen from `b`.
    #[inline(always)]
    fn velocity(&self, a: &Moving<R>, b: &Moving<R>) -> R {
        self.direction.dot(&(a.velocity - b.velocity)) + self.torques[0].dot(&a.spin)
            - self.torques[1].dot(&b.spin)
    }

    /// Makes the impulse what is given; how much that has changed the velocity here.
    #[inline(always)]
    fn apply(&mut self, impulse: R, a: &mut Moving<R>, b: &mut Moving<R>) -> R {
        let change = impulse - self.impulse;
        self.impulse = impulse;
        a.velocity += self.direction * (change * a.inverse_mass);
        a.spin += self.torques[0] * (change * a.inverse_inertia);
        b.velocity -= self.direction * (change * b.inverse_mass);
        b.spin -= self.torques[1] * (change * b.inverse_inertia);
        (change / self.mass).abs()
    }
}
