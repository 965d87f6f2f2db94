//! Bodies that have contacts, and the changes of their motion.
use nalgebra::Vector3;

use crate::world::rigid::simd::{Lane, Quad};
use crate::world::unit_cube::INVERSE_INERTIA;

#[derive(Clone, Copy, Debug)]
pub(super) struct SolverBody<R: Lane> {
    pub velocity: R::Quad,
    pub spin: R::Quad,
    pub inverse_mass: R,
    pub inverse_inertia: R,
}

/// Index of the immovable body.
pub(super) const GROUND: usize = 0;

/// Number that stands for a missing block or body.
pub(super) const NO_BLOCK: u32 = u32::MAX;

/// All bodies, [`GROUND`] first. The arrays are in the same order.
#[derive(Clone, Debug)]
pub(super) struct SolverBodies<R: Lane> {
    blocks: Vec<u32>,
    contacts: Vec<u32>,
    pub motions: Vec<SolverBody<R>>,
    /// Motions before any impulse.
    pub before: Vec<SolverBody<R>>,
    /// For each body, the velocity change that forces cause in the second half of the step. Used
    /// for rigid contacts and the wall.
    pub late: Vec<R::Quad>,
    /// Displacements that correct overlaps, applied in this substep only. Empty for compliant
    /// contacts.
    pub shifts: Vec<SolverBody<R>>,
    /// Index of the body of each block, or [`NO_BLOCK`].
    index: Vec<u32>,
    inverse_inertia: R,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct SolverBodyChange<R: Lane> {
    /// Change of the body's velocity.
    pub velocity: Vector3<R>,
    /// New spin of the body.
    pub spin: Vector3<R>,
    /// Overlap correction, as a velocity and a spin.
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
    /// Returns an empty list for `count` blocks. `turns` states whether contacts can rotate blocks.
    pub fn new(count: usize, turns: bool) -> SolverBodies<R> {
        SolverBodies {
            blocks: Vec::new(),
            contacts: Vec::new(),
            motions: Vec::new(),
            before: Vec::new(),
            late: Vec::new(),
            shifts: Vec::new(),
            index: vec![NO_BLOCK; count],
            inverse_inertia: if turns {
                R::from_double(INVERSE_INERTIA)
            } else {
                R::zero()
            },
        }
    }

    pub fn clear(&mut self) {
        for &id in self.blocks.iter().skip(1) {
            self.index[id as usize] = NO_BLOCK;
        }
        self.blocks.clear();
        self.blocks.push(NO_BLOCK);
        self.contacts.clear();
        self.contacts.push(0);
        self.motions.clear();
        self.motions.push(SolverBody::rest(R::zero(), R::zero()));
        self.late.clear();
        self.late.push(R::Quad::default());
    }

    /// Counts a contact of a free block and returns the index of its body. Adds the body at its
    /// first contact.
    pub fn add_contact(&mut self, id: u32) -> usize {
        let index = &mut self.index[id as usize];
        if *index == NO_BLOCK {
            *index = self.motions.len() as u32;
            self.blocks.push(id);
            self.contacts.push(0);
            self.motions
                .push(SolverBody::rest(R::one(), self.inverse_inertia));
            self.late.push(R::Quad::default());
        }
        self.contacts[*index as usize] += 1;
        *index as usize
    }

    /// Records a velocity change of a block by a force. Half of the change acts in the second half
    /// of the step.
    pub fn pushed(&mut self, id: u32, change: Vector3<R>) {
        if let Some(late) = self.late.get_mut(self.index[id as usize] as usize) {
            *late += R::Quad::pack(change * R::from_double(0.5));
        }
    }

    /// Returns whether these bodies have no other contact.
    pub fn is_alone(&self, bodies: [usize; 2]) -> bool {
        bodies.iter().all(|&index| self.contacts[index] <= 1)
    }

    /// Makes all bodies appear to have several contacts. For tests.
    #[cfg(test)]
    pub fn entangle(&mut self) {
        self.contacts.iter_mut().for_each(|count| *count += 2);
    }

    /// Loads the spins, and the velocities in the middle of the step. The velocities exclude
    /// `late`.
    ///
    /// `rigid` states whether overlaps are corrected.
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

    pub fn changes(&self) -> impl Iterator<Item = (u32, SolverBodyChange<R>)> + '_ {
        let indices = self.blocks.iter().enumerate().skip(1);
        indices.map(|(index, &id)| {
            let motion = &self.motions[index];
            let change = SolverBodyChange {
                velocity: (motion.velocity - self.before[index].velocity).unpack(),
                spin: motion.spin.unpack(),
                shift: self.shifts.get(index).map_or([Vector3::zeros(); 2], |by| {
                    [by.velocity.unpack(), by.spin.unpack()]
                }),
            };
            (id, change)
        })
    }

    /// Returns the moment of inertia, or 0 if contacts do not rotate blocks.
    pub fn inertia(&self) -> R {
        if self.inverse_inertia > R::zero() {
            R::one() / self.inverse_inertia
        } else {
            R::zero()
        }
    }
}
