//! Lattice structures: anchored blocks and open faces, for worlds whose blocks have cells but no
//! positions.
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use stochc_control::{BlockFace, Body, Docking, Orientation};
use stochc_estimate::{Neighbourhood, SIGHT};
use stochc_ir::table::Tables;
use stochc_ir::{Cell, Face};

use super::grid::ChunkedGrid;
use super::ranked::RankedSet;

/// Structure and free blocks of a lattice world.
///
/// A *seat* is a block index: first the blocks of the plate, then those that were free at the
/// start. A face has the index [`number`]`(seat, face)`. A face is *open* if it is on and the cell
/// in front is empty.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct LatticeStructure {
    /// Number of blocks that were free at the start.
    pub count: u32,
    /// Cells of the plate's blocks, sorted.
    pub seeds: Vec<Cell>,
    /// State of each anchored block.
    pub seats: Vec<AnchoredBlock>,
    /// Grid with a mark in every occupied cell.
    grid: ChunkedGrid<CellContent>,
    pub free: RankedSet,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FaceChange {
    /// The face can now capture.
    Opened(usize),
    /// The face can no longer capture.
    Closed(usize),
}

pub(super) type Changes = SmallVec<[FaceChange; 4]>;

/// Anchored block. Faces are in its own frame, one bit each.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct AnchoredBlock {
    pub cell: Cell,
    pub orientation: Orientation,
    /// Faces that are on and hold no block. Such a face is open only if the cell in front of it is
    /// also empty.
    pub on: u8,
    pub holding: u8,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct CellContent {
    /// Seat of the block in the cell.
    block: u32,
    /// Directions of the faces that are on and point into the cell, one bit each.
    aimed: u8,
}

/// Seat of an empty cell.
pub(super) const NO_BLOCK: u32 = u32::MAX;

/// Returns the index of a face among all faces.
pub(super) fn number(seat: usize, face: Face) -> usize {
    Face::ALL.len() * seat + face as usize
}

/// Returns the cells that are occupied at any time in the run.
pub(super) fn occupied_cells(tables: &Tables) -> impl Iterator<Item = Cell> {
    let seeds = tables.seeds().map(|(_, cell)| cell);
    seeds.chain(tables.captured_cells())
}

/// Returns the seat and the face of a [`number`].
pub(super) fn seat_and_face(number: usize) -> (usize, Face) {
    let faces = Face::ALL.len();
    (number / faces, Face::ALL[number % faces])
}

pub(super) fn bit(face: Face) -> u8 {
    1 << face as u8
}

#[inline]
pub(super) fn faces(mut bits: u8) -> impl Iterator<Item = Face> {
    std::iter::from_fn(move || {
        let face = *Face::ALL.get(bits.trailing_zeros() as usize)?;
        bits &= bits - 1;
        Some(face)
    })
}

impl AnchoredBlock {
    /// Returns the cell in front of a face, or `None` at or below the level of the plate.
    pub fn across(&self, face: Face) -> Option<Cell> {
        let cell = self.cell.across(self.orientation.to_structure(face))?;
        (cell.z >= 1).then_some(cell)
    }
}

impl LatticeStructure {
    /// Creates a structure of `count` free blocks and of the plate's blocks that these tables name.
    pub fn new(tables: &Tables, count: u32) -> LatticeStructure {
        let mut seeds: Vec<Cell> = tables.seeds().map(|(_, cell)| cell).collect();
        seeds.sort_unstable();
        let empty = CellContent {
            block: NO_BLOCK,
            aimed: 0,
        };
        let mut grid = ChunkedGrid::new(empty, occupied_cells(tables));
        for (number, &cell) in (0..).zip(&seeds) {
            grid.mark(cell, true).block = number;
        }
        let seat = |cell| AnchoredBlock {
            cell,
            orientation: Orientation::IDENTITY,
            on: 0,
            holding: 0,
        };
        let mut seats: Vec<AnchoredBlock> = seeds.iter().map(|cell| seat(*cell)).collect();
        seats.resize(seeds.len() + count as usize, seat(Cell::default()));
        LatticeStructure {
            count,
            free: RankedSet::full(count as usize),
            seeds,
            seats,
            grid,
        }
    }

    #[inline]
    pub fn seat(&self, body: Body) -> Option<usize> {
        match body {
            Body::Seed(cell) => self.block(cell).filter(|seat| *seat < self.seeds.len()),
            Body::Free(id) => {
                let is_anchored = id < self.count && !self.free.contains(id as usize);
                is_anchored.then(|| self.seeds.len() + id as usize)
            }
        }
    }

    #[inline]
    pub fn body(&self, seat: usize) -> Body {
        match self.seeds.get(seat) {
            Some(&cell) => Body::Seed(cell),
            None => Body::Free((seat - self.seeds.len()) as u32),
        }
    }

    /// Returns the seat of the block in a cell.
    pub fn block(&self, cell: Cell) -> Option<usize> {
        let block = self.grid.get(cell).block;
        (block != NO_BLOCK).then_some(block as usize)
    }

    /// Returns the occupancy of the cells around a cell above the plate.
    pub fn neighbourhood(&self, cell: Cell) -> Neighbourhood {
        let mut found = Neighbourhood::on_ground(cell);
        self.grid
            .each_marked_near(cell, SIGHT, |offset, _| found.block(offset));
        found
    }

    /// Returns the cell in front of a face if it is empty.
    pub fn target(&self, seat: usize, face: Face) -> Option<Cell> {
        let cell = self.seats[seat].across(face)?;
        self.block(cell).is_none().then_some(cell)
    }

    /// Returns the faces of neighbours that point into a cell. `directions` is the bit set of their
    /// directions.
    #[inline]
    fn aimed(&self, cell: Cell, directions: u8) -> impl Iterator<Item = (usize, Face)> {
        faces(directions).filter_map(move |direction| {
            let seat = self.block(cell.across(direction.opposite())?)?;
            Some((seat, self.seats[seat].orientation.to_own(direction)))
        })
    }

    /// Switches on a face of an anchored block, unless it is on or holds a block.
    #[inline]
    pub fn magnetize(&mut self, seat: usize, face: Face) -> Option<FaceChange> {
        let of = &mut self.seats[seat];
        if (of.on | of.holding) & bit(face) != 0 {
            return None;
        }
        of.on |= bit(face);
        let direction = of.orientation.to_structure(face);
        let content = self.grid.get_mut(of.across(face)?);
        content.aimed |= bit(direction);
        (content.block == NO_BLOCK).then(|| FaceChange::Opened(number(seat, face)))
    }

    /// Returns the capture of the free block `child` at a face. `pose` is the number of one of 24
    /// orientations. The block enters the reach of the face at the same tick.
    #[inline]
    pub fn docking(&self, seat: usize, face: Face, child: u32, pose: u8, tick: u64) -> Docking {
        Docking {
            block_face: BlockFace {
                body: self.body(seat),
                face,
            },
            child,
            child_face: Face::ALL[usize::from(pose / 4)],
            turn: pose % 4,
            entries: 1,
            entered: tick,
        }
    }

    /// Returns the capture of a pre-attached block. Returns `None` if the cell is occupied or no
    /// block is free.
    pub fn pre_attached(&self, seat: usize, face: Face, tick: u64) -> Option<(Cell, Docking)> {
        let cell = self.target(seat, face)?;
        let last = self.free.len().checked_sub(1)?;
        let parent = self.seats[seat].orientation;
        let (child_face, turn) = Orientation::IDENTITY.as_docked(parent, face)?;
        let docking = self.docking(seat, face, self.free.select(last) as u32, 0, tick);
        let docking = Docking {
            child_face,
            turn,
            ..docking
        };
        Some((cell, docking))
    }

    /// Puts a captured block into its empty cell. Calls `emit` with each change of a face.
    #[inline]
    pub fn dock(
        &mut self,
        seat: usize,
        face: Face,
        cell: Cell,
        docking: &Docking,
        mut emit: impl FnMut(FaceChange),
    ) {
        let (on, parent) = (number(seat, face), self.seats[seat]);
        let direction = parent.orientation.to_structure(face);
        let (child_face, turn) = (docking.child_face, docking.turn);
        let child = self.seeds.len() + docking.child as usize;
        self.seats[seat].on &= !bit(face);
        self.seats[seat].holding |= bit(face);
        self.seats[child] = AnchoredBlock {
            cell,
            orientation: Orientation::docked(parent.orientation, face, child_face, turn),
            on: 0,
            holding: 0,
        };
        self.free.remove(docking.child as usize);
        let content = self.grid.mark(cell, true);
        content.block = child as u32;
        content.aimed &= !bit(direction);
        let aimed = content.aimed;
        emit(FaceChange::Closed(on));
        for (seat, face) in self.aimed(cell, aimed) {
            emit(FaceChange::Closed(number(seat, face)));
        }
    }

    /// Switches a face off if it is on and holds nothing.
    pub fn close(&mut self, seat: usize, face: Face) -> Option<FaceChange> {
        let of = &mut self.seats[seat];
        if of.on & bit(face) == 0 {
            return None;
        }
        of.on &= !bit(face);
        let direction = of.orientation.to_structure(face);
        let cell = of.across(face)?;
        self.grid.get_mut(cell).aimed &= !bit(direction);
        Some(FaceChange::Closed(number(seat, face)))
    }

    /// Returns the faces of a block that are on or hold another block. These faces become inactive
    /// when the block leaves.
    pub fn active_faces(&self, seat: usize) -> impl Iterator<Item = (usize, Face)> + use<> {
        let AnchoredBlock { on, holding, .. } = self.seats[seat];
        faces(on | holding).map(move |face| (seat, face))
    }

    /// Removes the block that a face holds and returns its seat. Calls `emit` with each change of a
    /// face.
    pub fn release(
        &mut self,
        seat: usize,
        face: Face,
        mut emit: impl FnMut(FaceChange),
    ) -> Option<usize> {
        let of = &mut self.seats[seat];
        if of.holding & bit(face) == 0 {
            return None;
        }
        of.holding &= !bit(face);
        let cell = of.across(face)?;
        let content = self.grid.mark(cell, false);
        let child = std::mem::replace(&mut content.block, NO_BLOCK) as usize;
        let aimed = content.aimed;
        self.free.insert(child - self.seeds.len());
        for (seat, face) in self.aimed(cell, aimed) {
            emit(FaceChange::Opened(number(seat, face)));
        }
        Some(child)
    }
}
