//! Contacts of bodies that have no other contact, solved in SIMD lanes.
//!
//! Each lane is one contact, with the arithmetic of [`super::sequential`] in the same order.
//! Results do not depend on the other lanes. Inactive lanes continue with zero changes.
use super::contact_law::{FASTEST, Law, LawKind, RECOVERY, SLOP, Spring};
use super::contact_list::ContactList;
use super::solver_bodies::{SolverBodies, SolverBody};
use crate::world::rigid::simd::{ABREAST, Lane, Wide, cross, filled, first, sum, transposed};

/// Contacts of `N` moving bodies: two, or one against an immovable body.
#[derive(Clone, Debug, Default)]
pub(super) struct ParallelContacts<R: Lane, const N: usize> {
    /// Indices of these contacts among all contacts.
    numbers: Vec<usize>,
    /// Batches, including spare ones for reuse.
    groups: Vec<Batch<R, N>>,
}

/// Batch of at most [`ABREAST`] contacts.
#[derive(Clone, Debug)]
struct Batch<R: Lane, const N: usize> {
    /// Indices of the bodies among all bodies.
    indices: [[usize; N]; ABREAST],
    /// Mask of the lanes with a contact.
    real: R::Quad,
    bodies: [BatchBody<R>; N],
    /// Change of the relative velocity in the second half of the step, in the contact frame. A
    /// relative velocity is the first body's velocity minus the second body's velocity.
    late: BatchVector<R>,
    shifts: [BatchBody<R>; N],
    /// Unit vectors along the normal and across it.
    frame: [BatchVector<R>; 3],
    /// Softness of a compliant contact: reduction of the target velocity per unit impulse. 0 for
    /// rigid contacts.
    softness: R::Quad,
    spots: Vec<BatchPoint<R, N>>,
}

/// One vector per lane.
type BatchVector<R> = [<R as Lane>::Quad; 3];

/// First or second body of each contact in a batch.
#[derive(Clone, Copy, Debug)]
struct BatchBody<R: Lane> {
    velocity: BatchVector<R>,
    spin: BatchVector<R>,
    inverse_mass: R::Quad,
    inverse_inertia: R::Quad,
}

/// For each contact in a batch, the point with the same index.
#[derive(Clone, Copy, Debug)]
struct BatchPoint<R: Lane, const N: usize> {
    /// Mask of the contacts that have this point.
    real: R::Quad,
    depth: R::Quad,
    /// Target velocity along the normal \[block lengths / tick\], set by restitution or by a
    /// spring.
    target: R::Quad,
    /// Displacement per tick that corrects the overlap.
    recovery: R::Quad,
    /// Torques of unit impulses in the frame's directions, about the centres of the bodies.
    torques: [[BatchVector<R>; N]; 3],
    /// Effective masses: impulses for unit velocity change, along the normal and across it.
    masses: [R::Quad; 2],
    impulses: BatchVector<R>,
    shift: R::Quad,
}

impl<R: Lane, const N: usize> ParallelContacts<R, N> {
    pub fn clear(&mut self) {
        self.numbers.clear();
    }

    pub fn add(&mut self, number: usize) {
        self.numbers.push(number);
    }

    /// Returns the batches in use.
    fn groups(&mut self) -> &mut [Batch<R, N>] {
        &mut self.groups[..self.numbers.len().div_ceil(ABREAST)]
    }

    /// Loads all contacts. Returns the largest approach speed of their points.
    pub fn load(&mut self, touches: &ContactList<R>, moving: &SolverBodies<R>, law: &Law<R>) -> R {
        // Contacts with equal numbers of points share a batch.
        let points = |&number: &usize| std::cmp::Reverse(touches.list[number].points.len());
        self.numbers.sort_by_key(points);
        let groups = self.numbers.chunks(ABREAST);
        if self.groups.len() < groups.len() {
            self.groups.resize_with(groups.len(), Batch::new);
        }
        groups
            .zip(&mut self.groups)
            .fold(R::zero(), |fastest, (numbers, group)| {
                fastest.max(group.load(touches, numbers, moving, law))
            })
    }

    /// Finds the velocities of all bodies, within `tolerance`.
    pub fn push(&mut self, law: &Law<R>, rounds: u32, tolerance: R, inertia: R) {
        for group in self.groups() {
            group.push(law, rounds, tolerance, inertia);
        }
    }

    /// Reduces overlap corrections for points that separate by restitution.
    pub fn spare(&mut self) {
        for group in self.groups() {
            group.spare();
        }
    }

    /// Finds the displacements that correct overlaps.
    pub fn part(&mut self, rounds: u32, tolerance: R) {
        for group in self.groups() {
            group.part(rounds, tolerance);
        }
    }

    /// Stores the new velocities. For `rigid` contacts, also stores the displacements.
    pub fn store(&mut self, moving: &mut SolverBodies<R>, rigid: bool) {
        for group in self.groups() {
            group.store(moving, rigid);
        }
    }
}

impl<R: Lane, const N: usize> Batch<R, N> {
    fn new() -> Batch<R, N> {
        let nothing = BatchBody {
            velocity: [all::<R>(0.0); 3],
            spin: [all::<R>(0.0); 3],
            inverse_mass: all::<R>(1.0),
            inverse_inertia: all::<R>(0.0),
        };
        Batch {
            indices: [[0; N]; ABREAST],
            real: all::<R>(0.0),
            bodies: [nothing; N],
            late: [all::<R>(0.0); 3],
            shifts: [nothing; N],
            frame: [[all::<R>(0.0); 3]; 3],
            softness: all::<R>(0.0),
            spots: Vec::new(),
        }
    }

    /// Loads the contacts with the indices `numbers`, which are sorted by descending number of
    /// points. Returns the largest approach speed.
    fn load(
        &mut self,
        touches: &ContactList<R>,
        numbers: &[usize],
        moving: &SolverBodies<R>,
        law: &Law<R>,
    ) -> R {
        let list = filled(numbers).map(|number| &touches.list[number]);
        self.real = first::<R>(numbers.len());
        self.indices = list.map(|touch| std::array::from_fn(|which| touch.bodies[which]));
        self.frame = [0, 1, 2].map(|row| transposed(list.map(|touch| touch.frame[row].into())));
        for which in 0..N {
            let motions = list.map(|touch| &moving.motions[touch.bodies[which]]);
            self.bodies[which] = BatchBody::gather(motions);
            self.shifts[which] = BatchBody {
                velocity: [all::<R>(0.0); 3],
                spin: [all::<R>(0.0); 3],
                ..self.bodies[which]
            };
        }
        self.late = [all::<R>(0.0); 3];
        if law.restitution().is_some() {
            let late = transposed(list.map(|touch| {
                let late = match touch.bodies[..N] {
                    [a, b, ..] => moving.late[a] - moving.late[b],
                    [a, ..] => moving.late[a],
                    [] => R::Quad::default(),
                };
                let [x, y, z, _] = late.store();
                [x, y, z]
            }));
            self.late = (self.frame).map(|row| sum([0, 1, 2].map(|axis| row[axis] * late[axis])));
        }
        self.spots.clear();
        // The contact with the most points comes first.
        for nth in 0..list[0].points.len() {
            let have = numbers.partition_point(|&of| touches.list[of].points.len() > nth);
            let points = filled(&list[..have]).map(|touch| &touches.points_of(touch)[nth]);
            let [depth] = transposed(points.map(|point| [point.depth]));
            let arms: [BatchVector<R>; N] =
                std::array::from_fn(|which| transposed(points.map(|at| at.arms[which].into())));
            self.spots.push(BatchPoint {
                real: first::<R>(have),
                depth,
                target: all::<R>(0.0),
                recovery: all::<R>(0.0),
                torques: (self.frame).map(|direction| arms.map(|arm| cross(arm, direction))),
                masses: [all::<R>(0.0); 2],
                impulses: [all::<R>(0.0); 3],
                shift: all::<R>(0.0),
            });
        }
        let [span] = transposed(list.map(|touch| [touch.span]));
        self.prepare(law, span)
    }

    /// Computes the target velocity of each point. Returns the largest approach speed.
    ///
    /// `span` is the time over which forces act.
    fn prepare(&mut self, law: &Law<R>, span: R::Quad) -> R {
        let mut fastest = all::<R>(0.0);
        self.softness = all::<R>(0.0);
        for spot in &mut self.spots {
            let approach = velocity(&self.frame[0], &spot.torques[0], &self.bodies);
            let yields =
                |one: usize, two: usize| yields(&self.frame, &spot.torques, &self.bodies, one, two);
            fastest = fastest.maximum(spot.real.choose(approach.abs(), all::<R>(0.0)));
            match law.kind {
                LawKind::Rigid { restitution } => {
                    let target = R::Quad::splat(-restitution) * approach;
                    let lies = target.maximum(all::<R>(0.0) - self.late[0]);
                    spot.target = (all::<R>(0.0).above(approach)).choose(lies, target);
                    let excess = (spot.depth - all::<R>(SLOP)).maximum(all::<R>(0.0));
                    spot.recovery = (excess * all::<R>(RECOVERY) / span).minimum(all::<R>(FASTEST));
                }
                LawKind::Compliant { stiffness, damping } => {
                    let along = yields(0, 0);
                    let spring =
                        Spring::new::<R>(stiffness, damping, span, spot.depth, approach, along);
                    (spot.target, self.softness) = (spring.target, spring.softness);
                }
            }
            spot.masses[0] = all::<R>(1.0) / (yields(0, 0) + self.softness);
            if law.friction > R::zero() {
                let (k11, k22, k12) = (yields(1, 1), yields(2, 2), yields(1, 2));
                let (mean, half) = ((k11 + k22) * all::<R>(0.5), (k11 - k22) * all::<R>(0.5));
                spot.masses[1] = all::<R>(1.0) / (mean + (half * half + k12 * k12).sqrt());
            }
        }
        (fastest.store().into_iter()).fold(R::zero(), |most, approach| most.max(approach))
    }

    fn push(&mut self, law: &Law<R>, rounds: u32, tolerance: R, inertia: R) {
        let before = self.bodies;
        let mut bodies = before;
        let mut active = self.real;
        for _ in 0..rounds {
            let greatest = self.push_once(&mut bodies, law.friction, active);
            active = active & greatest.above(R::Quad::splat(tolerance));
            if active.bits() == 0 {
                break;
            }
        }
        self.bodies = bodies;
        if law.restitution().is_some_and(|part| part > R::zero()) {
            self.keep_energy(&before, inertia);
        }
    }

    /// Performs one round of impulses. Returns the largest velocity change at a point.
    #[inline(always)]
    fn push_once(
        &mut self,
        bodies: &mut [BatchBody<R>; N],
        friction: R,
        active: R::Quad,
    ) -> R::Quad {
        let mut greatest = all::<R>(0.0);
        let [along, across @ ..] = &self.frame;
        for spot in &mut self.spots {
            let active = active & spot.real;
            let missing = spot.target
                - velocity(along, &spot.torques[0], bodies)
                - self.softness * spot.impulses[0];
            let requested = (spot.impulses[0] + missing * spot.masses[0]).maximum(all::<R>(0.0));
            let change = spot.press(0, requested, active);
            push(change, along, &spot.torques[0], bodies);
            greatest = greatest.maximum((change / spot.masses[0]).abs());
            if friction > R::zero() {
                // Coulomb friction cone of the current normal impulse.
                let most = R::Quad::splat(friction) * spot.impulses[0];
                let [one, two] = [0, 1].map(|row| {
                    let slip =
                        velocity(&across[row], &spot.torques[row + 1], bodies) + self.late[row + 1];
                    spot.impulses[row + 1] - slip * spot.masses[1]
                });
                let square = one * one + two * two;
                let by = (square.above(most * most)).choose(most / square.sqrt(), all::<R>(1.0));
                for (row, requested) in [one * by, two * by].into_iter().enumerate() {
                    let change = spot.press(row + 1, requested, active);
                    push(change, &across[row], &spot.torques[row + 1], bodies);
                    greatest = greatest.maximum((change / spot.masses[1]).abs());
                }
            }
        }
        greatest
    }

    /// Reduces overlap corrections, as [`super::sequential::SequentialContacts::spare`] does.
    fn spare(&mut self) {
        for spot in &mut self.spots {
            let parting = velocity(&self.frame[0], &spot.torques[0], &self.bodies) + self.late[0];
            let missing = spot.recovery - parting.maximum(all::<R>(0.0));
            spot.recovery = missing.maximum(all::<R>(0.0));
        }
    }

    fn part(&mut self, rounds: u32, tolerance: R) {
        let mut active = self.real;
        for _ in 0..rounds {
            let greatest = self.part_once(active);
            active = active & greatest.above(R::Quad::splat(tolerance));
            if active.bits() == 0 {
                break;
            }
        }
    }

    /// Performs one round of overlap correction. Returns the largest change of speed at a point.
    fn part_once(&mut self, active: R::Quad) -> R::Quad {
        let mut greatest = all::<R>(0.0);
        let mut shifts = self.shifts;
        let along = &self.frame[0];
        for spot in &mut self.spots {
            let relative = velocity(along, &spot.torques[0], &shifts);
            let requested = spot.shift + (spot.recovery - relative) * spot.masses[0];
            let requested =
                (active & spot.real).choose(requested.maximum(all::<R>(0.0)), spot.shift);
            let change = requested - spot.shift;
            spot.shift = requested;
            push(change, along, &spot.torques[0], &mut shifts);
            greatest = greatest.maximum((change / spot.masses[0]).abs());
        }
        self.shifts = shifts;
        greatest
    }

    /// Limits the energy of the bodies to their energy before the contact.
    fn keep_energy(&mut self, before: &[BatchBody<R>; N], inertia: R) {
        let inertia = R::Quad::splat(inertia);
        let (mut work, mut square) = (all::<R>(0.0), all::<R>(0.0));
        for (now, before) in self.bodies.iter().zip(before) {
            let (faster, livelier) = now.less(before);
            let energy = |v: &BatchVector<R>, w: &BatchVector<R>| {
                sum([0, 1, 2]
                    .map(|axis| v[axis] * faster[axis] + w[axis] * livelier[axis] * inertia))
            };
            work += energy(&before.velocity, &before.spin);
            square += energy(&faster, &livelier);
        }
        let too_much = (work + work + square).above(all::<R>(0.0));
        let part = ((all::<R>(0.0) - (work + work)) / square).maximum(all::<R>(0.0));
        for (now, before) in self.bodies.iter_mut().zip(before) {
            let (faster, livelier) = now.less(before);
            for axis in 0..3 {
                let velocity = before.velocity[axis] + faster[axis] * part;
                let spin = before.spin[axis] + livelier[axis] * part;
                now.velocity[axis] = too_much.choose(velocity, now.velocity[axis]);
                now.spin[axis] = too_much.choose(spin, now.spin[axis]);
            }
        }
    }

    fn store(&self, moving: &mut SolverBodies<R>, rigid: bool) {
        let count = self.real.bits().count_ones() as usize;
        for which in 0..N {
            let indices = self.indices[..count].iter().map(|indices| indices[which]);
            self.bodies[which].scatter(indices.clone(), &mut moving.motions);
            if rigid {
                self.shifts[which].scatter(indices, &mut moving.shifts);
            }
        }
    }
}

impl<R: Lane, const N: usize> BatchPoint<R, N> {
    /// Sets an impulse to `requested` in the active lanes. Returns the change.
    #[inline(always)]
    fn press(&mut self, row: usize, requested: R::Quad, active: R::Quad) -> R::Quad {
        let before = self.impulses[row];
        self.impulses[row] = active.choose(requested, before);
        self.impulses[row] - before
    }
}

impl<R: Lane> BatchBody<R> {
    #[inline(always)]
    fn gather(motions: [&SolverBody<R>; ABREAST]) -> BatchBody<R> {
        let [x, y, z, u, v, w, mass, inertia] = transposed(motions.map(|motion| {
            let ([x, y, z, _], [u, v, w, _]) = (motion.velocity.store(), motion.spin.store());
            let (mass, inertia) = (motion.inverse_mass, motion.inverse_inertia);
            [x, y, z, u, v, w, mass, inertia]
        }));
        BatchBody {
            velocity: [x, y, z],
            spin: [u, v, w],
            inverse_mass: mass,
            inverse_inertia: inertia,
        }
    }

    /// Writes the motions back. Immovable bodies are skipped, because no impulse changes them.
    fn scatter(&self, indices: impl Iterator<Item = usize>, motions: &mut [SolverBody<R>]) {
        let [velocity, spin] = [self.velocity, self.spin].map(|vector| vector.map(Wide::store));
        for (lane, index) in indices.enumerate() {
            let vector = |[x, y, z]: &[[R; ABREAST]; 3]| {
                R::Quad::load(&[x[lane], y[lane], z[lane], R::zero()])
            };
            motions[index].velocity = vector(&velocity);
            motions[index].spin = vector(&spin);
        }
    }

    /// Returns the changes of velocity and spin since `before`.
    fn less(&self, before: &BatchBody<R>) -> (BatchVector<R>, BatchVector<R>) {
        (
            [0, 1, 2].map(|axis| self.velocity[axis] - before.velocity[axis]),
            [0, 1, 2].map(|axis| self.spin[axis] - before.spin[axis]),
        )
    }
}

/// Returns the same value in all lanes.
#[inline(always)]
fn all<R: Lane>(value: f64) -> R::Quad {
    R::Quad::splat(R::from_double(value))
}

/// Returns the relative velocity of the first body at a point in a direction.
#[inline(always)]
fn velocity<R: Lane, const N: usize>(
    direction: &BatchVector<R>,
    torques: &[BatchVector<R>; N],
    bodies: &[BatchBody<R>; N],
) -> R::Quad {
    sum([0, 1, 2].map(|axis| {
        let mut moved = bodies[0].velocity[axis];
        let mut turned = torques[0][axis] * bodies[0].spin[axis];
        for which in 1..N {
            moved -= bodies[which].velocity[axis];
            turned -= torques[which][axis] * bodies[which].spin[axis];
        }
        direction[axis] * moved + turned
    }))
}

/// Returns the velocity change that a unit impulse in direction `two` of the frame causes in
/// direction `one`.
#[inline(always)]
fn yields<R: Lane, const N: usize>(
    frame: &[BatchVector<R>; 3],
    torques: &[[BatchVector<R>; N]; 3],
    bodies: &[BatchBody<R>; N],
    one: usize,
    two: usize,
) -> R::Quad {
    let mut lightness = bodies[0].inverse_mass;
    for body in &bodies[1..] {
        lightness += body.inverse_mass;
    }
    sum([0, 1, 2].map(|axis| {
        let mut all = frame[one][axis] * frame[two][axis] * lightness;
        for which in 0..N {
            let turned = torques[one][which][axis] * torques[two][which][axis];
            all += turned * bodies[which].inverse_inertia;
        }
        all
    }))
}

#[inline(always)]
fn push<R: Lane, const N: usize>(
    impulse: R::Quad,
    direction: &BatchVector<R>,
    torques: &[BatchVector<R>; N],
    bodies: &mut [BatchBody<R>; N],
) {
    for which in 0..N {
        let body = &mut bodies[which];
        let moved = impulse * body.inverse_mass;
        let turned = impulse * body.inverse_inertia;
        for axis in 0..3 {
            let (by, about) = (direction[axis] * moved, torques[which][axis] * turned);
            if which == 0 {
                body.velocity[axis] += by;
                body.spin[axis] += about;
            } else {
                body.velocity[axis] -= by;
                body.spin[axis] -= about;
            }
        }
    }
}
