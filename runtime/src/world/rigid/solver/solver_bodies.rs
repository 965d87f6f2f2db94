//! The bodies that touch something, and how contacts change their motion.
use nalgebra::Vector3;

use crate::world::rigid::simd::{Lane, Quad};
use crate::world::unit_cube::INVERSE_INERTIA;

/// How a body moves, and how much it minds being pushed.
#[derive(Clone, Copy, Debug)]
pub(super) struct SolverBody<R: Lane> {
    pub velocity: R::Quad,
    pub spin: R::Quad,
    pub inverse_mass: R,
    pub inverse_inertia: R,
}

/// The first body is the ground, or something else that never moves.
pub(super) const GROUND: usize = 0;

/// No block, or none of the bodies.
pub(super) const NOBODY: u32 = u32::MAX;

/// All bodies, [`GROUND`] first: the arrays are in the same order.
#[derive(Clone, Debug)]
pub(super) struct SolverBodies<R: Lane> {
    /// Their numbers as blocks.
    blocks: Vec<u32>,
    /// In how many contacts each is.
    contacts: Vec<u32>,
    pub motions: Vec<SolverBody<R>>,
    /// Their motions before any impulse.
    pub before: Vec<SolverBody<R>>,
    /// Of rigid contacts and the shell: what forces have changed velocities by after the middle of the step.
    pub late: Vec<R::Quad>,
    /// What undoes overlaps: moves the blocks in this substep and is forgotten. Empty if contacts give way.
    pub shifts: Vec<SolverBody<R>>,
    /// Which body a block is, or [`NOBODY`].
    place: Vec<u32>,
    inverse_inertia: R,
}

/// What contacts have done to a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct SolverBodyChange<R: Lane> {
    /// By how much its velocity is another.
    pub velocity: Vector3<R>,
    /// Its spin now.
    pub spin: Vector3<R>,
    /// What undoes its overlaps, as a velocity and a spin.
    pub shift: [Vector3<R>; 2],
}

impl<R: Lane> SolverBody<R> {
    fn rest(inverse_mass: R, inverse_inertia: R) -> SolverBody<R> {
        SolverBody {
            velocity: R::Quad::default(),
            spin: R::Quad::default(),
            inverse_mass,
            inverse_inertia,
        }
    }
}

impl<R: Lane> SolverBodies<R> {
    /// Of `count` blocks in all; `turns`: whether contacts can turn blocks at all.
    pub fn new(count: usize, turns: bool) -> SolverBodies<R> {
        SolverBodies {
            blocks: Vec::new(),
            contacts: Vec::new(),
            motions: Vec::new(),
            before: Vec::new(),
            late: Vec::new(),
            shifts: Vec::new(),
            place: vec![NOBODY; count],
            inverse_inertia: if turns {
                R::of(INVERSE_INERTIA)
            } else {
                R::zero()
            },
        }
    }

    pub fn clear(&mut self) {
        for &id in self.blocks.iter().skip(1) {
            self.place[id as usize] = NOBODY;
        }
        self.blocks.clear();
        self.blocks.push(NOBODY);
        self.contacts.clear();
        self.contacts.push(0);
        self.motions.clear();
        self.motions.push(SolverBody::rest(R::zero(), R::zero()));
        self.late.clear();
        self.late.push(R::Quad::default());
    }

    /// The body of a free block in one more contact; it gets its place in the lists at its first one.
    pub fn place(&mut self, id: u32) -> usize {
        let place = &mut self.place[id as usize];
        if *place == NOBODY {
            *place = self.motions.len() as u32;
            self.blocks.push(id);
            self.contacts.push(0);
            self.motions
                .push(SolverBody::rest(R::one(), self.inverse_inertia));
            self.late.push(R::Quad::default());
        }
        self.contacts[*place as usize] += 1;
        *place as usize
    }

    /// A force has changed the velocity of a block by so much, half of it after the middle of the step.
    pub fn pushed(&mut self, id: u32, change: Vector3<R>) {
        if let Some(late) = self.late.get_mut(self.place[id as usize] as usize) {
            *late += R::Quad::pack(change * R::of(0.5));
        }
    }

    /// Whether none of these bodies is in another contact as well.
    pub fn is_alone(&self, bodies: [usize; 2]) -> bool {
        bodies.iter().all(|&place| self.contacts[place] <= 1)
    }

    /// Has all bodies seem to be in several contacts.
    #[cfg(test)]
    pub fn entangle(&mut self) {
        self.contacts.iter_mut().for_each(|count| *count += 2);
    }

    /// Begins with the velocities of the blocks in the middle of the step: as they are, less what is `late`; and with their spins.
    ///
    /// `rigid`: whether overlaps are undone.
    pub fn start(&mut self, rigid: bool, motion_of: impl Fn(u32) -> [Vector3<R>; 3]) {
        self.shifts.clear();
        if rigid {
            self.shifts.extend_from_slice(&self.motions);
        }
        let motions = self.motions.iter_mut().zip(&mut self.late);
        for ((motion, late), &id) in motions.zip(&self.blocks).skip(1) {
            let [velocity, spin, later] = motion_of(id);
            *late += R::Quad::pack(later);
            motion.velocity = R::Quad::pack(velocity) - *late;
            motion.spin = R::Quad::pack(spin);
        }
        self.before.clone_from(&self.motions);
    }

    /// What has become of each block.
    pub fn changes(&self) -> impl Iterator<Item = (u32, SolverBodyChange<R>)> + '_ {
        let places = self.blocks.iter().enumerate().skip(1);
        places.map(|(place, &id)| {
            let motion = &self.motions[place];
            let change = SolverBodyChange {
                velocity: (motion.velocity - self.before[place].velocity).unpack(),
                spin: motion.spin.unpack(),
                shift: self.shifts.get(place).map_or([Vector3::zeros(); 2], |by| {
                    [by.velocity.unpack(), by.spin.unpack()]
                }),
            };
            (id, change)
        })
    }

    /// Of a body that contacts turn; 0: they do not.
    pub fn inertia(&self) -> R {
        if self.inverse_inertia > R::zero() {
            R::one() / self.inverse_inertia
        } else {
            R::zero()
        }
    }
}
