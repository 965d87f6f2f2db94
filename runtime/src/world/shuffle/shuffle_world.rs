//! Lattice world with a random order of captures.
use std::collections::BTreeMap;

use smallvec::{SmallVec, smallvec};
use stochc_control::{BlockFace, Body, Docking, Orientation};
use stochc_ir::table::Tables;
use stochc_ir::{Cell, Face};

use super::groups::DisjointSets;
use super::unplanned_faces::ExposedFaces;
use crate::counter_rng::{DrawsAhead, Stream, below, unit};
use crate::world::lattice::{FaceChange, LatticeStructure, NO_BLOCK, bit, seat_and_face};
use crate::world::ranked::RankedSet;
use crate::world::{Fault, World};

/// Lattice world. The cost of a tick is almost independent of the number of blocks.
#[derive(Clone, Debug)]
pub struct ShuffleWorld {
    tick: u64,
    draws: DrawsAhead,
    /// Probability per tick of a capture at a face that is off.
    strays: f64,
    /// Groups of free blocks. `None` if free blocks do not bond.
    groups: Option<DisjointSets>,
    pub(super) lattice: LatticeStructure,
    /// Open faces, by the index of the face. Each seat has six indices.
    open: RankedSet,
    /// Accessible faces that are switched off: first faces of the plate, then faces of blocks above
    /// it. Used only for stray captures.
    pub(super) exposed: [ExposedFaces; 2],
}

stochc_ir::state! {
    () ShuffleWorld;
    values: tick, groups, lattice, open, exposed;
    parts: ;
    same: draws, strays
}

impl ShuffleWorld {
    /// Returns a world of `count` free blocks and of the plate's blocks that these tables name.
    /// (`seed`, `run`) is the key of its random draws.
    pub fn new(tables: &Tables, count: u32, seed: u64, run: u64) -> ShuffleWorld {
        let lattice = LatticeStructure::new(tables, count);
        ShuffleWorld {
            tick: 0,
            draws: DrawsAhead::new(seed, run, Stream::Shuffle),
            strays: 0.0,
            groups: None,
            open: RankedSet::empty(Face::ALL.len() * lattice.seats.len()),
            lattice,
            exposed: Default::default(),
        }
    }

    /// Lets two random free blocks bond to each other in about every other tick.
    pub(crate) fn with_groups(self) -> ShuffleWorld {
        ShuffleWorld {
            groups: Some(DisjointSets::new(self.lattice.count)),
            ..self
        }
    }

    /// Adds stray captures, with this probability per tick, at accessible faces that are off. This
    /// imitates faces that always attract.
    pub fn with_strays(self, probability: f64) -> ShuffleWorld {
        let mut world = ShuffleWorld {
            strays: probability,
            ..self
        };
        for seat in 0..world.lattice.seeds.len() {
            world.expose(world.lattice.seats[seat].cell);
        }
        world
    }

    /// Returns the occupied cells above the plate, each with its block.
    pub fn cells(&self) -> BTreeMap<Cell, u32> {
        let of = &self.lattice;
        let anchored = (0..of.count).filter(|id| !of.free.contains(*id as usize));
        let seats = &of.seats[of.seeds.len()..];
        anchored.map(|id| (seats[id as usize].cell, id)).collect()
    }

    /// Returns the orientation of an anchored block.
    pub fn orientation(&self, body: Body) -> Option<Orientation> {
        match body {
            Body::Seed(_) => Some(Orientation::IDENTITY),
            Body::Free(_) => Some(self.lattice.seats[self.lattice.seat(body)?].orientation),
        }
    }
}

impl ShuffleWorld {
    /// Puts a captured block into its empty cell, and updates the open faces.
    #[inline]
    fn dock(&mut self, seat: usize, face: Face, cell: Cell, docking: &Docking) {
        let emit = |change| note(&mut self.open, change);
        self.lattice.dock(seat, face, cell, docking, emit);
        self.expose(cell);
    }

    /// Updates which faces in and around a cell are accessible to stray blocks.
    #[inline]
    fn expose(&mut self, cell: Cell) {
        if self.strays > 0.0 {
            self.expose_around(cell);
        }
    }

    fn expose_around(&mut self, cell: Cell) {
        let around = Face::ALL.into_iter().filter_map(|face| cell.across(face));
        for cell in around.chain([cell]) {
            let seat = self.lattice.block(cell);
            let is_seed = cell.z == 0;
            let faces = seat.map_or(0, |seat| {
                let on = self.lattice.seats[seat].on;
                let exposed = Face::ALL.into_iter().filter(|&face| {
                    on & bit(face) == 0 && self.lattice.target(seat, face).is_some()
                });
                exposed.fold(0, |faces, face| faces | bit(face))
            });
            let exposed = &mut self.exposed[usize::from(!is_seed)];
            exposed.set(cell, seat.map_or(NO_BLOCK, |seat| seat as u32), faces);
        }
    }

    /// Bonds two random blocks and their groups, with some probability.
    #[inline]
    fn gather(&mut self) {
        let Some(groups) = &mut self.groups else {
            return;
        };
        let [whether, one, other, _] = self.draws.block(self.tick, 2);
        let count = self.lattice.count;
        if count > 0 && unit(whether) >= 0.5 {
            groups.join(below(one, count), below(other, count));
        }
    }

    /// Performs an unplanned capture, with some probability.
    #[inline]
    fn stray(&mut self, dockings: &mut Vec<Docking>) {
        if self.strays > 0.0 {
            self.draw_stray(dockings);
        }
    }

    fn draw_stray(&mut self, dockings: &mut Vec<Docking>) {
        let [whether, which, which_block, how] = self.draws.block(self.tick, 1);
        if unit(whether) >= self.strays {
            return;
        }
        let [seeds, blocks] = &self.exposed;
        let all = seeds.len() + blocks.len();
        let rank = below(which, all);
        let seat_and_face = match rank.checked_sub(seeds.len()) {
            None => seeds.select(rank),
            Some(rank) => blocks.select(rank),
        };
        if let Some((seat, face)) = seat_and_face {
            self.dock_one(seat as usize, face, [which_block, how], dockings);
        }
    }

    /// Captures a free block at an accessible face. Two random words select the block and its
    /// orientation.
    #[inline]
    fn dock_one(
        &mut self,
        seat: usize,
        face: Face,
        [which_block, how]: [u32; 2],
        dockings: &mut Vec<Docking>,
    ) {
        let of = &self.lattice;
        let free = of.free.len();
        let Some(cell) = of.seats[seat].across(face).filter(|_| free > 0) else {
            return;
        };
        let child = of.free.select(below(which_block, free)) as u32;
        let docking = of.docking(seat, face, child, below(how, 24) as u8, self.tick);
        self.dock(seat, face, cell, &docking);
        dockings.push(docking);
    }
}

#[inline]
fn note(open: &mut RankedSet, change: FaceChange) {
    match change {
        FaceChange::Opened(face) => open.insert(face),
        FaceChange::Closed(face) => open.remove(face),
    }
}

impl World for ShuffleWorld {
    fn tick(&self) -> u64 {
        self.tick
    }

    fn magnetize(&mut self, block_face: BlockFace) {
        let Some(seat) = self.lattice.seat(block_face.body) else {
            return;
        };
        if let Some(change) = self.lattice.magnetize(seat, block_face.face) {
            note(&mut self.open, change);
        }
        self.expose(self.lattice.seats[seat].cell);
    }

    fn switch_off(&mut self, block_face: BlockFace) {
        let Some(seat) = self.lattice.seat(block_face.body) else {
            return;
        };
        let mut going: SmallVec<[_; 8]> = smallvec![(seat, block_face.face)];
        while let Some((seat, face)) = going.pop() {
            let mut emit = |change| note(&mut self.open, change);
            if let Some(closed) = self.lattice.close(seat, face) {
                emit(closed);
            }
            if let Some(child) = self.lattice.release(seat, face, emit) {
                going.extend(self.lattice.active_faces(child));
                self.expose(self.lattice.seats[child].cell);
            }
            self.expose(self.lattice.seats[seat].cell);
        }
    }

    fn plant(&mut self, block_face: BlockFace) -> Option<Docking> {
        self.magnetize(block_face);
        let seat = self.lattice.seat(block_face.body)?;
        let (cell, docking) = self
            .lattice
            .pre_attached(seat, block_face.face, self.tick)?;
        self.dock(seat, block_face.face, cell, &docking);
        Some(docking)
    }

    fn largest_group(&self) -> u32 {
        self.groups.as_ref().map_or(1, DisjointSets::largest)
    }

    fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault> {
        self.gather();
        self.stray(dockings);
        let tick = self.tick;
        self.tick += 1;
        if self.open.len() > 0 {
            let [which, which_block, how, _] = self.draws.block(tick, 0);
            let (seat, face) = seat_and_face(self.open.select(below(which, self.open.len())));
            self.dock_one(seat, face, [which_block, how], dockings);
        }
        Ok(())
    }
}
