//! Contacts: which there are, and the impulses that keep them (sequential impulses, Catto 2005).
//!
//! A rigid contact is solved twice: for velocities, with restitution and Coulomb's friction, and
//! for the overlap that the time step has let through, by a motion that leaves no velocity behind.
//! A compliant one is a spring and a damper, taken implicitly. Contacts are visited again only as
//! long as one of their two bodies has changed since.
use std::ops::Range;

use nalgebra::Vector3;
use petgraph::unionfind::UnionFind;
use stochc_compiler::scene::ContactLaw;

use super::bodies::Bodies;
use super::lanes::{Lane, Quad};
use super::overlap::Patch;
use crate::world::magnet::INVERSE_INERTIA;
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
pub(super) struct Solver<R: Lane> {
    law: Law<R>,
    inverse_inertia: R,
    iterations: u32,
    /// The blocks that touch something, after [`GROUND`]; `shifts` and `changed` are theirs as well.
    blocks: Vec<u32>,
    motions: Vec<Motion<R>>,
    /// Their motions before any impulse.
    before: Vec<Motion<R>>,
    /// What undoes overlaps: moves the blocks in this substep and is forgotten.
    shifts: Vec<Motion<R>>,
    /// When a body was changed last, counted in visits.
    changed: Vec<u32>,
    contacts: Vec<Touch>,
    /// The points of all contacts.
    spots: Vec<Spot<R>>,
    /// Index into `motions` by number of a block, or [`NOBODY`].
    place: Vec<u32>,
}

const NOBODY: u32 = u32::MAX;

/// The first body is the ground, or something else that never moves.
const GROUND: usize = 0;

/// How a body moves, and how much it minds being pushed.
#[derive(Clone, Copy, Debug)]
struct Motion<R: Lane> {
    velocity: R::Quad,
    spin: R::Quad,
    inverse_mass: R,
    inverse_inertia: R,
}

impl<R: Lane> Motion<R> {
    fn rest(inverse_mass: R, inverse_inertia: R) -> Motion<R> {
        Motion {
            velocity: R::Quad::default(),
            spin: R::Quad::default(),
            inverse_mass,
            inverse_inertia,
        }
    }
}

/// Two bodies that touch, or one and the ground.
#[derive(Clone, Debug)]
struct Touch {
    a: usize,
    b: usize,
    points: Range<usize>,
    /// When it was visited last, in visits; whether it was content then.
    visited: u32,
    content: bool,
}

/// One point of a contact.
#[derive(Clone, Copy, Debug)]
struct Spot<R: Lane> {
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
struct Row<R: Lane> {
    direction: R::Quad,
    /// Torque of a unit impulse about the centres of the two bodies.
    torques: [R::Quad; 2],
    /// Impulse that changes the velocity here by one.
    mass: R,
    impulse: R,
}

impl<R: Lane> Solver<R> {
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
            blocks: Vec::new(),
            motions: Vec::new(),
            before: Vec::new(),
            shifts: Vec::new(),
            changed: Vec::new(),
            contacts: Vec::new(),
            spots: Vec::new(),
            place: vec![NOBODY; count],
        }
    }

    /// Forgets all contacts.
    pub fn clear(&mut self) {
        for &id in self.blocks.iter().skip(1) {
            self.place[id as usize] = NOBODY;
        }
        let ground = Motion::rest(R::zero(), R::zero());
        self.blocks.clear();
        self.blocks.push(NOBODY);
        self.motions.clear();
        self.motions.push(ground);
        self.contacts.clear();
        self.spots.clear();
    }

    /// Adds the contact of block `a` with block `b`, or with something that never moves.
    pub fn add(&mut self, bodies: &Bodies<R>, a: u32, b: Option<u32>, patch: &Patch<R>) {
        let centre = |id: u32| bodies.centre(id as usize);
        let arm_of =
            |id: Option<u32>, place| id.map_or_else(Vector3::zeros, |id| place - centre(id));
        let (first, second) = (
            self.moving(bodies, a),
            b.map_or(GROUND, |b| self.moving(bodies, b)),
        );
        let normal = patch.normal;
        let across = if normal.x.abs() < R::of(0.7) {
            Vector3::x()
        } else {
            Vector3::y()
        };
        let one = normal.cross(&across).normalize();
        let tangents = [one, normal.cross(&one)];
        let from = self.spots.len();
        self.spots.extend(patch.points.iter().map(|point| {
            let arms = [arm_of(Some(a), point.place), arm_of(b, point.place)];
            let row = |direction: Vector3<R>| Row {
                direction: R::Quad::pack(direction),
                torques: arms.map(|arm| R::Quad::pack(arm.cross(&direction))),
                mass: R::zero(),
                impulse: R::zero(),
            };
            Spot {
                depth: point.depth,
                target: R::zero(),
                softness: R::zero(),
                recovery: R::zero(),
                along: row(normal),
                across: tangents.map(row),
                shift: R::zero(),
            }
        }));
        self.contacts.push(Touch {
            a: first,
            b: second,
            points: from..self.spots.len(),
            visited: 0,
            content: false,
        });
    }

    /// The body of a block, which gets its place in the lists at its first contact.
    fn moving(&mut self, bodies: &Bodies<R>, id: u32) -> usize {
        if !bodies.is_free(id as usize) {
            return GROUND;
        }
        let place = &mut self.place[id as usize];
        if *place == NOBODY {
            *place = self.motions.len() as u32;
            self.blocks.push(id);
            self.motions
                .push(Motion::rest(R::one(), self.inverse_inertia));
        }
        *place as usize
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
        if self.contacts.is_empty() {
            return;
        }
        self.shifts.clear();
        self.shifts.extend_from_slice(&self.motions);
        self.before.clear();
        self.before.push(self.motions[GROUND]);
        for (motion, &id) in self.motions.iter_mut().zip(&self.blocks).skip(1) {
            let i = id as usize;
            let velocity = bodies.velocity(i);
            let place = bodies.centre(i) - velocity * bodies.dt;
            motion.velocity = R::Quad::pack(velocity - late(place));
            motion.spin = R::Quad::pack(bodies.spin[i]);
            self.before.push(*motion);
        }
        let mut fastest = R::zero();
        for contact in &self.contacts {
            let spots = &mut self.spots[contact.points.clone()];
            let approach = contact.prepare(spots, &self.motions, &self.law, bodies.dt);
            fastest = fastest.max(approach);
        }
        let tolerance = fastest * R::of(PRECISION);
        let friction = self.law.friction;
        let mut motions = std::mem::take(&mut self.motions);
        self.repeat(|contact, spots| contact.push(spots, &mut motions, friction) > tolerance);
        self.motions = motions;
        if let Kind::Rigid { restitution } = self.law.kind {
            if restitution > R::zero() {
                self.keep_energy();
            }
            let tolerance = R::of(FASTEST * PRECISION);
            let mut shifts = std::mem::take(&mut self.shifts);
            self.repeat(|contact, spots| contact.part(spots, &mut shifts) > tolerance);
            self.shifts = shifts;
        }
        let dt = bodies.dt;
        let rigid = matches!(self.law.kind, Kind::Rigid { .. });
        for (place, &id) in self.blocks.iter().enumerate().skip(1) {
            let i = id as usize;
            let (motion, shift) = (&self.motions[place], &self.shifts[place]);
            let change = (motion.velocity - self.before[place].velocity).unpack();
            bodies.set_centre(
                i,
                bodies.centre(i) + (change + shift.velocity.unpack()) * dt,
            );
            bodies.set_velocity(i, bodies.velocity(i) + change);
            if rigid {
                bodies.turn_now(i, shift.spin.unpack() * dt);
            } else {
                // What it is turned by now, it was turned to before its spin changes.
                bodies.rotation_now(i);
            }
            bodies.spin[i] = motion.spin.unpack();
            moved(bodies, i);
        }
    }

    /// Takes back what rounds cut short have given too much: blocks that hang together by contacts
    /// must not be livelier than before. All their impulses are made smaller alike, which keeps
    /// momentum.
    fn keep_energy(&mut self) {
        let mut groups = UnionFind::<usize>::new(self.motions.len());
        for contact in &self.contacts {
            if contact.a != GROUND && contact.b != GROUND {
                groups.union(contact.a, contact.b);
            }
        }
        let inertia = if self.inverse_inertia > R::zero() {
            R::one() / self.inverse_inertia
        } else {
            R::zero()
        };
        let before = |place: usize| (self.before[place].velocity, self.before[place].spin);
        // Twice the energy is E0 + 2 s work + s^2 square, with s the part of the impulses.
        let mut sums = vec![(R::zero(), R::zero()); self.motions.len()];
        for (place, motion) in self.motions.iter().enumerate().skip(1) {
            let (velocity, spin) = before(place);
            let (faster, livelier) = (motion.velocity - velocity, motion.spin - spin);
            let (work, square) = &mut sums[groups.find(place)];
            *work += (velocity * faster + (spin * livelier).scaled(inertia)).sum();
            *square += (faster * faster + (livelier * livelier).scaled(inertia)).sum();
        }
        for place in 1..self.motions.len() {
            let (work, square) = sums[groups.find(place)];
            if work + work + square > R::zero() {
                let part = (-(work + work) / square).max(R::zero());
                let (velocity, spin) = before(place);
                let motion = &mut self.motions[place];
                motion.velocity = velocity + (motion.velocity - velocity).scaled(part);
                motion.spin = spin + (motion.spin - spin).scaled(part);
            }
        }
    }

    /// Visits contacts until none changes anything, or for as many rounds as are allowed.
    fn repeat(&mut self, mut visit: impl FnMut(&Touch, &mut [Spot<R>]) -> bool) {
        let mut visits = 0;
        for contact in &mut self.contacts {
            (contact.visited, contact.content) = (0, false);
        }
        self.changed.clear();
        self.changed
            .resize(self.motions.len().max(self.shifts.len()), 0);
        for _ in 0..self.iterations {
            let mut content = true;
            for contact in &mut self.contacts {
                let last = self.changed[contact.a].max(self.changed[contact.b]);
                if contact.content && last <= contact.visited {
                    continue;
                }
                visits += 1;
                let spots = &mut self.spots[contact.points.clone()];
                let has_changed = visit(contact, spots);
                contact.content = !has_changed;
                contact.visited = visits;
                if has_changed {
                    content = false;
                    self.changed[contact.a] = visits;
                    self.changed[contact.b] = visits;
                    // Whatever happens, the ground has not changed.
                    self.changed[GROUND] = 0;
                }
            }
            if content {
                break;
            }
        }
    }
}

impl Touch {
    /// Works out what each point asks for; the fastest approach.
    fn prepare<R: Lane>(
        &self,
        spots: &mut [Spot<R>],
        motions: &[Motion<R>],
        law: &Law<R>,
        dt: R,
    ) -> R {
        let (a, b) = (motions[self.a], motions[self.b]);
        let mut fastest = R::zero();
        // Together the points of a compliant contact are as stiff as one at the deepest of them.
        let share = match law.kind {
            Kind::Rigid { .. } => R::one(),
            Kind::Compliant { .. } => {
                let depths = spots.iter().map(|p| p.depth);
                let deepest = depths
                    .clone()
                    .fold(R::zero(), |most, depth| most.max(depth));
                deepest / depths.fold(R::zero(), |sum, depth| sum + depth)
            }
        };
        for point in spots {
            let approach = point.along.velocity(&a, &b);
            fastest = fastest.max(approach.abs());
            match law.kind {
                Kind::Rigid { restitution } => {
                    // Of a point that recedes as well: what a rocking patch is given must not
                    // make it livelier than it was.
                    point.target = -restitution * approach;
                    let excess = (point.depth - R::of(SLOP)).max(R::zero());
                    point.recovery = (excess * R::of(RECOVERY) / dt).min(R::of(FASTEST));
                }
                Kind::Compliant { stiffness, damping } => {
                    let (stiffness, damping) = (stiffness * share, damping * share);
                    let firmness = dt * (damping + dt * stiffness);
                    point.softness = R::one() / firmness;
                    point.target = point.depth * stiffness * dt / firmness;
                }
            }
            point.along.mass =
                R::one() / (point.along.yields(&point.along, &a, &b) + point.softness);
            if law.friction > R::zero() {
                let [one, two] = &point.across;
                let (k11, k22) = (one.yields(one, &a, &b), two.yields(two, &a, &b));
                let k12 = one.yields(two, &a, &b);
                let (mean, half) = ((k11 + k22) * R::of(0.5), (k11 - k22) * R::of(0.5));
                // One mass for all sideways directions, the least there is: with one for each, a
                // contact that slides would be held in another direction than it slides in.
                let mass = R::one() / (mean + (half * half + k12 * k12).sqrt());
                for across in &mut point.across {
                    across.mass = mass;
                }
            }
        }
        fastest
    }

    /// One round of impulses; the greatest change of velocity at a point.
    fn push<R: Lane>(&self, spots: &mut [Spot<R>], motions: &mut [Motion<R>], friction: R) -> R {
        let mut greatest = R::zero();
        let (mut a, mut b) = (motions[self.a], motions[self.b]);
        for point in spots {
            let row = &mut point.along;
            let missing = point.target - row.velocity(&a, &b) - point.softness * row.impulse;
            let impulse = (row.impulse + missing * row.mass).max(R::zero());
            greatest = greatest.max(row.apply(impulse, &mut a, &mut b));
            // Coulomb's cone, of the impulse that presses now.
            let most = friction * point.along.impulse;
            if most > R::zero() || point.across[0].impulse != R::zero() {
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
        }
        (motions[self.b], motions[self.a]) = (b, a);
        greatest
    }

    /// One round of undoing overlaps; the greatest change of speed at a point.
    fn part<R: Lane>(&self, spots: &mut [Spot<R>], motions: &mut [Motion<R>]) -> R {
        let mut greatest = R::zero();
        let (mut a, mut b) = (motions[self.a], motions[self.b]);
        for point in spots {
            let row = &point.along;
            let relative = row.velocity(&a, &b);
            let shift = (point.shift + (point.recovery - relative) * row.mass).max(R::zero());
            let change = shift - point.shift;
            point.shift = shift;
            row.push(change, &mut a, &mut b);
            greatest = greatest.max((change / row.mass).abs());
        }
        (motions[self.b], motions[self.a]) = (b, a);
        greatest
    }
}

impl<R: Lane> Row<R> {
    /// How much the velocity in this direction changes by a unit impulse in the other.
    fn yields(&self, other: &Row<R>, a: &Motion<R>, b: &Motion<R>) -> R {
        let turned = |i: usize| self.torques[i] * other.torques[i];
        let moved = self.direction * other.direction;
        (moved.scaled(a.inverse_mass + b.inverse_mass)
            + turned(0).scaled(a.inverse_inertia)
            + turned(1).scaled(b.inverse_inertia))
        .sum()
    }

    /// Of `a` as seen from `b`.
    #[inline(always)]
    fn velocity(&self, a: &Motion<R>, b: &Motion<R>) -> R {
        let turned = self.torques[0] * a.spin - self.torques[1] * b.spin;
        (self.direction * (a.velocity - b.velocity) + turned).sum()
    }

    /// Makes the impulse what is given; how much that has changed the velocity here.
    #[inline(always)]
    fn apply(&mut self, impulse: R, a: &mut Motion<R>, b: &mut Motion<R>) -> R {
        let change = impulse - self.impulse;
        self.impulse = impulse;
        self.push(change, a, b);
        (change / self.mass).abs()
    }

    /// Pushes both bodies apart by an impulse.
    #[inline(always)]
    fn push(&self, impulse: R, a: &mut Motion<R>, b: &mut Motion<R>) {
        a.velocity += self.direction.scaled(impulse * a.inverse_mass);
        a.spin += self.torques[0].scaled(impulse * a.inverse_inertia);
        b.velocity -= self.direction.scaled(impulse * b.inverse_mass);
        b.spin -= self.torques[1].scaled(impulse * b.inverse_inertia);
    }
}
