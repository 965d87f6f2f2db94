//! Contacts that share bodies, solved in sequence and repeatedly.
//!
//! A contact is revisited only if one of its bodies has changed since.
use std::ops::Range;

use petgraph::unionfind::UnionFind;

use super::contact_law::{FASTEST, Law, LawKind, RECOVERY, SLOP, Spring};
use super::contact_list::{ContactList, ContactPoint, TouchingBodies};
use super::solver_bodies::{GROUND, SolverBodies, SolverBody};
use crate::world::rigid::simd::{Lane, Quad, Wide};

/// Contacts of bodies that have several contacts.
#[derive(Clone, Debug, Default)]
pub(super) struct SequentialContacts<R: Lane> {
    contacts: Vec<SequentialContact>,
    /// Points of all contacts.
    spots: Vec<PointConstraint<R>>,
    /// Number of the visit that last changed each body.
    changed: Vec<u32>,
}

/// Contact, and the result of its last visit.
#[derive(Clone, Debug)]
struct SequentialContact {
    a: usize,
    b: usize,
    points: Range<usize>,
    /// Number of the last visit to the contact.
    visited: u32,
    /// Whether the last visit changed nothing.
    content: bool,
}

#[derive(Clone, Copy, Debug)]
struct PointConstraint<R: Lane> {
    /// Depth of the overlap \[block lengths\].
    depth: R,
    /// Target velocity along the normal \[block lengths / tick\], set by restitution or by a
    /// spring.
    target: R,
    /// Softness of a compliant contact: reduction of the target velocity per unit impulse. 0 for
    /// rigid contacts.
    softness: R,
    /// Displacement per tick that corrects the overlap.
    recovery: R,
    /// Velocity change in the second half of the step, along the normal and across it.
    late: [R; 3],
    along: ConstraintRow<R>,
    across: [ConstraintRow<R>; 2],
    shift: R,
}

/// Direction of the impulses between two bodies at a point.
#[derive(Clone, Copy, Debug)]
struct ConstraintRow<R: Lane> {
    direction: R::Quad,
    /// Torques of a unit impulse about the centres of the two bodies.
    torques: [R::Quad; 2],
    /// Effective mass: impulse for unit velocity change.
    mass: R,
    impulse: R,
}

impl<R: Lane> SequentialContacts<R> {
    pub fn clear(&mut self) {
        self.contacts.clear();
        self.spots.clear();
    }

    /// Adds a contact. Returns the largest approach speed of its points.
    pub fn add(
        &mut self,
        touches: &ContactList<R>,
        touch: &TouchingBodies<R>,
        moving: &SolverBodies<R>,
        law: &Law<R>,
    ) -> R {
        let from = self.spots.len();
        let points = touches.points_of(touch).iter();
        self.spots
            .extend(points.map(|point| PointConstraint::new(touch, point)));
        let [a, b] = touch.bodies;
        let contact = SequentialContact {
            a,
            b,
            points: from..self.spots.len(),
            visited: 0,
            content: false,
        };
        let approach = contact.prepare(&mut self.spots[from..], moving, law, touch.span);
        self.contacts.push(contact);
        approach
    }

    /// Finds the velocities of all bodies. Stops when no point changes by more than `tolerance`.
    pub fn push(&mut self, moving: &mut SolverBodies<R>, law: &Law<R>, rounds: u32, tolerance: R) {
        let (motions, friction) = (&mut moving.motions, law.friction);
        self.repeat(motions, rounds, |contact, spots, motions| {
            contact.push(spots, motions, friction) > tolerance
        });
        if law.restitution().is_some_and(|part| part > R::zero()) {
            self.keep_energy(moving);
        }
    }

    /// Reduces overlap corrections for points that separate by restitution. Correction and
    /// restitution together would add energy.
    pub fn spare(&mut self, moving: &SolverBodies<R>) {
        for contact in &self.contacts {
            let (a, b) = (&moving.motions[contact.a], &moving.motions[contact.b]);
            for point in &mut self.spots[contact.points.clone()] {
                let parting = point.along.velocity(a, b) + point.late[0];
                point.recovery = (point.recovery - parting.max(R::zero())).max(R::zero());
            }
        }
    }

    /// Finds the displacements that correct overlaps.
    pub fn part(&mut self, moving: &mut SolverBodies<R>, rounds: u32, tolerance: R) {
        self.repeat(&mut moving.shifts, rounds, |contact, spots, shifts| {
            contact.part(spots, shifts) > tolerance
        });
    }

    /// Removes energy gained by an incomplete iteration. Scales all impulses within a connected set
    /// of blocks equally, which conserves momentum.
    fn keep_energy(&self, moving: &mut SolverBodies<R>) {
        let mut groups = UnionFind::<usize>::new(moving.motions.len());
        let mut chained = vec![false; moving.motions.len()];
        for contact in &self.contacts {
            (chained[contact.a], chained[contact.b]) = (true, true);
            if contact.a != GROUND && contact.b != GROUND {
                groups.union(contact.a, contact.b);
            }
        }
        let inertia = moving.inertia();
        let of_chains = |index: &usize| chained[*index];
        let SolverBodies {
            motions, before, ..
        } = moving;
        let before = |index: usize| (before[index].velocity, before[index].spin);
        // Twice the energy is E0 + 2 s work + s^2 square. Here s is the fraction of the impulses
        // that is kept.
        let mut sums = vec![(R::zero(), R::zero()); motions.len()];
        for index in (1..motions.len()).filter(of_chains) {
            let motion = &motions[index];
            let (velocity, spin) = before(index);
            let (faster, livelier) = (motion.velocity - velocity, motion.spin - spin);
            let (work, square) = &mut sums[groups.find(index)];
            *work += (velocity * faster + (spin * livelier).scaled(inertia)).sum();
            *square += (faster * faster + (livelier * livelier).scaled(inertia)).sum();
        }
        for index in (1..motions.len()).filter(of_chains) {
            let (work, square) = sums[groups.find(index)];
            if work + work + square > R::zero() {
                let part = (-(work + work) / square).max(R::zero());
                let (velocity, spin) = before(index);
                let motion = &mut motions[index];
                motion.velocity = velocity + (motion.velocity - velocity).scaled(part);
                motion.spin = spin + (motion.spin - spin).scaled(part);
            }
        }
    }

    /// Visits contacts until nothing changes, at most `rounds` times.
    fn repeat(
        &mut self,
        motions: &mut [SolverBody<R>],
        rounds: u32,
        visit: impl Fn(&SequentialContact, &mut [PointConstraint<R>], &mut [SolverBody<R>]) -> bool,
    ) {
        let mut visits = 0;
        for contact in &mut self.contacts {
            (contact.visited, contact.content) = (0, false);
        }
        self.changed.clear();
        self.changed.resize(motions.len(), 0);
        for _ in 0..rounds {
            let mut content = true;
            for contact in &mut self.contacts {
                let last = self.changed[contact.a].max(self.changed[contact.b]);
                if contact.content && last <= contact.visited {
                    continue;
                }
                visits += 1;
                let spots = &mut self.spots[contact.points.clone()];
                let has_changed = visit(contact, spots, motions);
                contact.content = !has_changed;
                contact.visited = visits;
                if has_changed {
                    content = false;
                    self.changed[contact.a] = visits;
                    self.changed[contact.b] = visits;
                    // The ground never changes.
                    self.changed[GROUND] = 0;
                }
            }
            if content {
                break;
            }
        }
    }
}

impl<R: Lane> PointConstraint<R> {
    fn new(touch: &TouchingBodies<R>, point: &ContactPoint<R>) -> PointConstraint<R> {
        let [along, one, two] = touch.frame.map(|direction| ConstraintRow {
            direction: R::Quad::pack(direction),
            torques: point.arms.map(|arm| R::Quad::pack(arm.cross(&direction))),
            mass: R::zero(),
            impulse: R::zero(),
        });
        PointConstraint {
            depth: point.depth,
            target: R::zero(),
            softness: R::zero(),
            recovery: R::zero(),
            late: [R::zero(); 3],
            along,
            across: [one, two],
            shift: R::zero(),
        }
    }
}

impl SequentialContact {
    /// Computes the target velocity of each point. Returns the largest approach speed.
    ///
    /// `span` is the time over which forces act.
    fn prepare<R: Lane>(
        &self,
        spots: &mut [PointConstraint<R>],
        moving: &SolverBodies<R>,
        law: &Law<R>,
        span: R,
    ) -> R {
        let [a, b] = [self.a, self.b].map(|index| moving.motions[index]);
        let late = moving.late[self.a] - moving.late[self.b];
        let mut fastest = R::zero();
        for point in spots {
            let approach = point.along.velocity(&a, &b);
            let along = point.along.yields(&point.along, &a, &b);
            fastest = fastest.max(approach.abs());
            match law.kind {
                LawKind::Rigid { restitution } => {
                    // Separating points also have a target. Otherwise, impulses on a rocking patch
                    // would add energy.
                    let target = -restitution * approach;
                    point.late = [&point.along, &point.across[0], &point.across[1]]
                        .map(|row| (row.direction * late).sum());
                    // Resting blocks stay at rest: the target includes their weight in the second
                    // half of the step.
                    point.target = if approach < R::zero() {
                        target.max(-point.late[0])
                    } else {
                        target
                    };
                    let excess = (point.depth - R::from_double(SLOP)).max(R::zero());
                    point.recovery =
                        (excess * R::from_double(RECOVERY) / span).min(R::from_double(FASTEST));
                }
                LawKind::Compliant { stiffness, damping } => {
                    let [duration, depth, parting, yields] =
                        [span, point.depth, approach, along].map(R::Quad::splat);
                    let spring =
                        Spring::new::<R>(stiffness, damping, duration, depth, parting, yields);
                    [point.target, point.softness] =
                        [spring.target, spring.softness].map(|lanes| lanes.store()[0]);
                }
            }
            point.along.mass = R::one() / (along + point.softness);
            if law.friction > R::zero() {
                let [one, two] = &point.across;
                let (k11, k22) = (one.yields(one, &a, &b), two.yields(two, &a, &b));
                let k12 = one.yields(two, &a, &b);
                let (mean, half) = (
                    (k11 + k22) * R::from_double(0.5),
                    (k11 - k22) * R::from_double(0.5),
                );
                // All tangential directions share the smallest effective mass. Different masses
                // would deflect friction from the sliding direction.
                let mass = R::one() / (mean + (half * half + k12 * k12).sqrt());
                for across in &mut point.across {
                    across.mass = mass;
                }
            }
        }
        fastest
    }

    /// Performs one round of impulses. Returns the largest velocity change at a point.
    fn push<R: Lane>(
        &self,
        spots: &mut [PointConstraint<R>],
        motions: &mut [SolverBody<R>],
        friction: R,
    ) -> R {
        let mut greatest = R::zero();
        let (mut a, mut b) = (motions[self.a], motions[self.b]);
        for point in spots {
            let row = &mut point.along;
            let missing = point.target - row.velocity(&a, &b) - point.softness * row.impulse;
            let impulse = (row.impulse + missing * row.mass).max(R::zero());
            greatest = greatest.max(row.apply(impulse, &mut a, &mut b));
            // Coulomb friction cone of the current normal impulse.
            let most = friction * point.along.impulse;
            if most > R::zero() || point.across[0].impulse != R::zero() {
                let mut requested = [R::zero(); 2];
                let rows = point.across.iter().zip(&point.late[1..]);
                for (requested, (row, &late)) in requested.iter_mut().zip(rows) {
                    *requested = row.impulse - (row.velocity(&a, &b) + late) * row.mass;
                }
                let [one, two] = requested;
                let square = one * one + two * two;
                if square > most * most {
                    let by = most / square.sqrt();
                    requested = [one * by, two * by];
                }
                for (requested, row) in requested.into_iter().zip(&mut point.across) {
                    greatest = greatest.max(row.apply(requested, &mut a, &mut b));
                }
            }
        }
        (motions[self.b], motions[self.a]) = (b, a);
        greatest
    }

    /// Performs one round of overlap correction. Returns the largest change of speed at a point.
    fn part<R: Lane>(&self, spots: &mut [PointConstraint<R>], motions: &mut [SolverBody<R>]) -> R {
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

impl<R: Lane> ConstraintRow<R> {
    /// Returns the velocity change that a unit impulse in the other row's direction causes in this
    /// row's direction.
    fn yields(&self, other: &ConstraintRow<R>, a: &SolverBody<R>, b: &SolverBody<R>) -> R {
        let turned = |i: usize| self.torques[i] * other.torques[i];
        let moved = self.direction * other.direction;
        (moved.scaled(a.inverse_mass + b.inverse_mass)
            + turned(0).scaled(a.inverse_inertia)
            + turned(1).scaled(b.inverse_inertia))
        .sum()
    }

    /// Returns the velocity of `a` relative to `b`.
    #[inline(always)]
    fn velocity(&self, a: &SolverBody<R>, b: &SolverBody<R>) -> R {
        let turned = self.torques[0] * a.spin - self.torques[1] * b.spin;
        (self.direction * (a.velocity - b.velocity) + turned).sum()
    }

    /// Sets the impulse. Returns the resulting velocity change.
    #[inline(always)]
    fn apply(&mut self, impulse: R, a: &mut SolverBody<R>, b: &mut SolverBody<R>) -> R {
        let change = impulse - self.impulse;
        self.impulse = impulse;
        self.push(change, a, b);
        (change / self.mass).abs()
    }

    #[inline(always)]
    fn push(&self, impulse: R, a: &mut SolverBody<R>, b: &mut SolverBody<R>) {
        a.velocity += self.direction.scaled(impulse * a.inverse_mass);
        a.spin += self.torques[0].scaled(impulse * a.inverse_inertia);
        b.velocity -= self.direction.scaled(impulse * b.inverse_mass);
        b.spin -= self.torques[1].scaled(impulse * b.inverse_inertia);
    }
}
