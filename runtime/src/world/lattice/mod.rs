//! Who is anchored where and which faces are open, for worlds in which blocks have no places but cells.
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use stochc_ir::table::Tables;
use stochc_ir::{Cell, Face};
use stochc_protocol::{BlockFace, Body, Docking, Orientation};
use stochc_rates::{Neighbourhood, SIGHT};

use super::grid::ChunkedGrid;
use super::ranked::RankedSet;

/// The structure, and the blocks that are free.
///
/// A *seat* is a block's number: first those of the plate, then those that were free at the beginning. A face has the number
/// [`number`]`(seat, face)`. A face is *open* if it is on and there is room before it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct LatticeStructure {
    /// Blocks that were free at the beginning.
    pub count: u32,
    /// The cells of the blocks of the plate, sorted.
    pub seeds: Vec<Cell>,
    /// Where each block is, while it is anchored.
    pub seats: Vec<AnchoredBlock>,
    /// Cells with a block are marked.
    grid: ChunkedGrid<CellContent>,
    /// The blocks that are free, by number.
    pub free: RankedSet,
}

/// What happened to a face.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FaceChange {
    /// It can capture from now on.
    Opened(usize),
    /// It cannot any more.
    Closed(usize),
}

/// What happened to the faces, in order.
pub(super) type Changes = SmallVec<[FaceChange; 4]>;

/// Where an anchored block is. Faces are its own, one bit each.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct AnchoredBlock {
    pub cell: Cell,
    pub orientation: Orientation,
    /// Those that are on and hold nothing.
    pub on: u8,
    /// Those that hold a block.
    pub holding: u8,
}

/// What is in a cell.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct CellContent {
    /// The seat of its block.
    block: u32,
    /// From which neighbours a face that is on points to it: the directions of those faces, one bit each.
    aimed: u8,
}

/// The seat of no block.
pub(super) const NOBODY: u32 = u32::MAX;

/// The number of a face among all.
pub(super) fn number(seat: usize, face: Face) -> usize {
    Face::ALL.len() * seat + face as usize
}

/// The cells in which there are blocks sooner or later.
pub(super) fn occupied_cells(tables: &Tables) -> impl Iterator<Item = Cell> {
    let seeds = tables.seeds().map(|(_, cell)| cell);
    seeds.chain(tables.captured_cells())
}

/// The seat and the face of a [`number`].
pub(super) fn site(number: usize) -> (usize, Face) {
    let faces = Face::ALL.len();
    (number / faces, Face::ALL[number % faces])
}

/// The bit of a face.
pub(super) fn bit(face: Face) -> u8 {
    1 << face as u8
}

/// The faces of a set of bits.
#[inline]
pub(super) fn faces(mut bits: u8) -> impl Iterator<Item = Face> {
    std::iter::from_fn(move || {
        let face = *Face::ALL.get(bits.trailing_zeros() as usize)?;
        bits &= bits - 1;
        Some(face)
    })
}

impl AnchoredBlock {
    /// Where a block would sit that docks on a face; `None`: on the plate's level or below nobody can.
    pub fn across(&self, face: Face) -> Option<Cell> {
        let cell = self.cell.across(self.orientation.to_structure(face))?;
        (cell.z >= 1).then_some(cell)
    }
}

impl LatticeStructure {
    /// `count` free blocks around the blocks of the plate that have a name in these tables.
    pub fn new(tables: &Tables, count: u32) -> LatticeStructure {
        let mut seeds: Vec<Cell> = tables.seeds().map(|(_, cell)| cell).collect();
        seeds.sort_unstable();
        let empty = CellContent {
            block: NOBODY,
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

    /// The seat of an anchored block.
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

    /// The block on a seat.
    #[inline]
    pub fn body(&self, seat: usize) -> Body {
        match self.seeds.get(seat) {
            Some(&cell) => Body::Seed(cell),
            None => Body::Free((seat - self.seeds.len()) as u32),
        }
    }

    /// The seat of the block in a cell.
    pub fn block(&self, cell: Cell) -> Option<usize> {
        let block = self.grid.get(cell).block;
        (block != NOBODY).then_some(block as usize)
    }

    /// The cells around one above the plate.
    pub fn neighbourhood(&self, cell: Cell) -> Neighbourhood {
        let mut found = Neighbourhood::on_ground(cell);
        self.grid
            .each_marked_near(cell, SIGHT, |offset, _| found.block(offset));
        found
    }

    /// Where a block that docks on a face would sit; `None`: there is no room.
    pub fn target(&self, seat: usize, face: Face) -> Option<Cell> {
        let cell = self.seats[seat].across(face)?;
        self.block(cell).is_none().then_some(cell)
    }

    /// The neighbours of a cell whose faces point to it along these ways, with those faces.
    #[inline]
    fn aimed(&self, cell: Cell, ways: u8) -> impl Iterator<Item = (usize, Face)> {
        faces(ways).filter_map(move |way| {
            let seat = self.block(cell.across(way.opposite())?)?;
            Some((seat, self.seats[seat].orientation.to_own(way)))
        })
    }

    /// Switches a face of an anchored block on, unless it is, or holds a block.
    #[inline]
    pub fn magnetize(&mut self, seat: usize, face: Face) -> Option<FaceChange> {
        let of = &mut self.seats[seat];
        if (of.on | of.holding) & bit(face) != 0 {
            return None;
        }
        of.on |= bit(face);
        let way = of.orientation.to_structure(face);
        let content = self.grid.get_mut(of.across(face)?);
        content.aimed |= bit(way);
        (content.block == NOBODY).then(|| FaceChange::Opened(number(seat, face)))
    }

    /// A docking of the free block of a rank on a face, in one of 24 poses; entered as late as it docks.
    #[inline]
    pub fn docking(&self, seat: usize, face: Face, child: u32, pose: u8, tick: u64) -> Docking {
        Docking {
            site: BlockFace {
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

    /// The docking of a block that is put on a face by hand; `None`: there is no room, or no free block.
    pub fn planted(&self, seat: usize, face: Face, tick: u64) -> Option<(Cell, Docking)> {
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

    /// Puts a block that docks on a face into its cell, which is empty, and tells what happens to faces.
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
        let way = parent.orientation.to_structure(face);
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
        content.aimed &= !bit(way);
        let aimed = content.aimed;
        emit(FaceChange::Closed(on));
        for (seat, face) in self.aimed(cell, aimed) {
            emit(FaceChange::Closed(number(seat, face)));
        }
    }

    /// Switches a face off, if it was on and held nothing.
    pub fn close(&mut self, seat: usize, face: Face) -> Option<FaceChange> {
        let of = &mut self.seats[seat];
        if of.on & bit(face) == 0 {
            return None;
        }
        of.on &= !bit(face);
        let way = of.orientation.to_structure(face);
        let cell = of.across(face)?;
        self.grid.get_mut(cell).aimed &= !bit(way);
        Some(FaceChange::Closed(number(seat, face)))
    }

    /// The faces of a block that are on or hold another one: what goes when the block does.
    pub fn active_faces(&self, seat: usize) -> impl Iterator<Item = (usize, Face)> + use<> {
        let AnchoredBlock { on, holding, .. } = self.seats[seat];
        faces(on | holding).map(move |face| (seat, face))
    }

    /// Takes the block that a face holds out of its cell: its seat. Tells what happens to faces.
    pub fn let_go(
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
        let child = std::mem::replace(&mut content.block, NOBODY) as usize;
        let aimed = content.aimed;
        self.free.insert(child - self.seeds.len());
        for (seat, face) in self.aimed(cell, aimed) {
            emit(FaceChange::Opened(number(seat, face)));
        }
        Some(child)
    }
}
