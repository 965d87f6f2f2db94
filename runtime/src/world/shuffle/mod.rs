//! A world without physics: each tick one magnetized face, drawn at random, captures a block.
//!
//! It has the structure's geometry and no other: good for testing a protocol under many orders of
//! events, useless for times.
mod exposed;
mod grid;
mod groups;
mod ranked;

use std::collections::BTreeMap;

use smallvec::{SmallVec, smallvec};
use stochc_ir::table::Tables;
use stochc_ir::{Cell, Face};
use stochc_protocol::{BlockFace, Body, Docking, Orientation};

use super::{Fault, World};
use crate::counter_rng::{DrawsAhead, Stream, below, unit};
use exposed::{ExposedFaces, bit};
use grid::Grid;
use groups::Groups;
use ranked::RankedSet;

/// A world of cells. A tick takes about the same time however many blocks there are.
#[derive(Clone, Debug)]
pub struct ShuffleWorld {
    tick: u64,
    draws: DrawsAhead,
    /// Blocks that were free at the beginning.
    count: u32,
    /// Chance per tick that a block docks on a face that is off.
    strays: f64,
    /// `None`: free blocks do not bond.
    groups: Option<Groups>,
    /// The cells of the blocks of the plate, sorted.
    seeds: Vec<Cell>,
    /// Where each block is: first those of the plate, then those that were free by number, while they are anchored.
    seats: Vec<AnchoredBlock>,
    grid: Grid<CellContent>,
    /// The faces that are on and to which a block can come: six numbers for each seat.
    open: RankedSet,
    /// The blocks that are free, by number.
    free: RankedSet,
    /// Where there are strays: the faces of the plate, and of blocks above it, that are off and to which a block can
    /// come.
    exposed: [ExposedFaces; 2],
}

/// Where an anchored block is. Faces are its own, one bit each.
#[derive(Clone, Copy, Debug)]
struct AnchoredBlock {
    cell: Cell,
    orientation: Orientation,
    /// Those that are on and hold nothing; also [`WORKED`].
    on: u8,
    /// Those that hold a block.
    holding: u8,
}

/// What is in a cell.
#[derive(Clone, Copy, Debug)]
struct CellContent {
    /// The seat of its block.
    block: u32,
    /// From which neighbours a face that is on points to it: the directions of those faces, one bit each.
    aimed: u8,
}

/// That a block has had a face on.
const WORKED: u8 = 1 << Face::ALL.len();

/// The seat of no block.
const NOBODY: u32 = u32::MAX;

impl AnchoredBlock {
    /// Where a block would sit that docks on a face; `None`: on the plate's level or below nobody can.
    fn across(&self, face: Face) -> Option<Cell> {
        let cell = self.cell.across(self.orientation.to_structure(face))?;
        (cell.z >= 1).then_some(cell)
    }
}

impl ShuffleWorld {
    /// A world of `count` free blocks around the blocks of the plate that have a name in these tables; its
    /// chance is that of (`seed`, `run`).
    pub fn new(tables: &Tables, count: u32, seed: u64, run: u64) -> ShuffleWorld {
        let mut seeds: Vec<Cell> = tables.seeds().map(|(_, cell)| cell).collect();
        seeds.sort_unstable();
        let mut grid = Grid::new(CellContent {
            block: NOBODY,
            aimed: 0,
        });
        for (number, &cell) in (0..).zip(&seeds) {
            grid.get_mut(cell).block = number;
        }
        let seat = |cell| AnchoredBlock {
            cell,
            orientation: Orientation::IDENTITY,
            on: 0,
            holding: 0,
        };
        let mut seats: Vec<AnchoredBlock> = seeds.iter().map(|cell| seat(*cell)).collect();
        seats.resize(seeds.len() + count as usize, seat(Cell::default()));
        ShuffleWorld {
            tick: 0,
            draws: DrawsAhead::new(seed, run, Stream::Shuffle),
            count,
            strays: 0.0,
            groups: None,
            open: RankedSet::empty(Face::ALL.len() * seats.len()),
            free: RankedSet::full(count as usize),
            seeds,
            seats,
            grid,
            exposed: Default::default(),
        }
    }

    /// The same, where in about every other tick two free blocks drawn at random bond to each other.
    pub fn with_groups(self) -> ShuffleWorld {
        ShuffleWorld {
            groups: Some(Groups::new(self.count)),
            ..self
        }
    }

    /// The same, where with this chance per tick a block also docks on a face that nobody has
    /// switched on, of those to which a block can come: as where every face always attracts.
    pub fn with_strays(self, probability: f64) -> ShuffleWorld {
        ShuffleWorld {
            strays: probability,
            ..self
        }
    }

    /// The occupied cells above the plate, each with the number of its block.
    pub fn cells(&self) -> BTreeMap<Cell, u32> {
        let anchored = (0..self.count).filter(|id| !self.free.contains(*id as usize));
        let seats = &self.seats[self.seeds.len()..];
        anchored.map(|id| (seats[id as usize].cell, id)).collect()
    }

    /// How an anchored block sits.
    pub fn orientation(&self, body: Body) -> Option<Orientation> {
        match body {
            Body::Seed(_) => Some(Orientation::IDENTITY),
            Body::Free(_) => Some(self.seats[self.seat(body)?].orientation),
        }
    }
}

impl ShuffleWorld {
    /// The seat of an anchored block.
    fn seat(&self, body: Body) -> Option<usize> {
        match body {
            Body::Seed(cell) => self.block(cell).filter(|seat| *seat < self.seeds.len()),
            Body::Free(id) => {
                let is_anchored = id < self.count && !self.free.contains(id as usize);
                is_anchored.then(|| self.seeds.len() + id as usize)
            }
        }
    }

    /// The seat of the block in a cell.
    fn block(&self, cell: Cell) -> Option<usize> {
        let block = self.grid.get(cell).block;
        (block != NOBODY).then_some(block as usize)
    }

    /// Where a block that docks on a face would sit; `None`: there is no room.
    fn target(&self, seat: usize, face: Face) -> Option<Cell> {
        let cell = self.seats[seat].across(face)?;
        self.block(cell).is_none().then_some(cell)
    }

    /// The neighbours of a cell that have a face on that points to it, with that face.
    fn aimed(&self, cell: Cell) -> impl Iterator<Item = (usize, Face)> {
        let aimed = self.grid.get(cell).aimed;
        let ways = Face::ALL
            .into_iter()
            .filter(move |way| aimed & bit(*way) != 0);
        ways.filter_map(move |way| {
            let seat = self.block(cell.across(way.opposite())?)?;
            Some((seat, self.seats[seat].orientation.to_own(way)))
        })
    }

    /// Puts a block that docks on a face into its cell, which is empty.
    fn dock(&mut self, seat: usize, face: Face, cell: Cell, docking: &Docking) {
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
        let content = self.grid.get_mut(cell);
        content.block = child as u32;
        content.aimed &= !bit(way);
        self.open.remove(on);
        if content.aimed != 0 {
            let blocked: Vec<_> = self.aimed(cell).collect();
            for (seat, face) in blocked {
                self.open.remove(number(seat, face));
            }
        }
        self.expose(cell);
    }

    /// Switches a face off, if it was on and held nothing.
    fn close(&mut self, seat: usize, face: Face) {
        let of = &mut self.seats[seat];
        if of.on & bit(face) == 0 {
            return;
        }
        of.on &= !bit(face);
        let way = of.orientation.to_structure(face);
        if let Some(cell) = of.across(face) {
            self.grid.get_mut(cell).aimed &= !bit(way);
            self.open.remove(number(seat, face));
        }
    }

    /// Takes the block that a face holds out of its cell: its seat.
    fn let_go(&mut self, seat: usize, face: Face) -> Option<usize> {
        let of = &mut self.seats[seat];
        if of.holding & bit(face) == 0 {
            return None;
        }
        of.holding &= !bit(face);
        let cell = of.across(face)?;
        let child = self.block(cell)?;
        self.grid.get_mut(cell).block = NOBODY;
        self.free.insert(child - self.seeds.len());
        let opened: Vec<_> = self.aimed(cell).collect();
        for (seat, face) in opened {
            self.open.insert(number(seat, face));
        }
        Some(child)
    }

    /// Notes which faces in and around a cell a stray can come to.
    fn expose(&mut self, cell: Cell) {
        if self.strays <= 0.0 {
            return;
        }
        let around = Face::ALL.into_iter().filter_map(|face| cell.across(face));
        for cell in around.chain([cell]) {
            let seat = self.block(cell);
            let is_seed = cell.z == 0;
            let faces = seat.map_or(0, |seat| {
                let on = self.seats[seat].on;
                let exposed = Face::ALL.into_iter().filter(|&face| {
                    // Of the plate, only blocks that have been at work.
                    let counts = !is_seed || (face == Face::Up && on & WORKED != 0);
                    counts && on & bit(face) == 0 && self.target(seat, face).is_some()
                });
                exposed.fold(0, |faces, face| faces | bit(face))
            });
            let exposed = &mut self.exposed[usize::from(!is_seed)];
            exposed.set(cell, seat.map_or(NOBODY, |seat| seat as u32), faces);
        }
    }

    /// By chance, two blocks bond, and with them their groups.
    fn gather(&mut self) {
        let Some(groups) = &mut self.groups else {
            return;
        };
        let [whether, one, other, _] = self.draws.block(self.tick, 2);
        if self.count > 0 && unit(whether) >= 0.5 {
            groups.join(below(one, self.count), below(other, self.count));
        }
    }

    /// By chance, a block docks where nobody expects it.
    fn stray(&mut self, dockings: &mut Vec<Docking>) {
        if self.strays <= 0.0 {
            return;
        }
        let [whether, which, who, how] = self.draws.block(self.tick, 1);
        if unit(whether) >= self.strays {
            return;
        }
        let [seeds, blocks] = &self.exposed;
        let all = seeds.len() + blocks.len();
        let rank = below(which, all);
        let site = match rank.checked_sub(seeds.len()) {
            None => seeds.select(rank),
            Some(rank) => blocks.select(rank),
        };
        if let Some((seat, face)) = site {
            self.dock_one(seat as usize, face, [who, how], dockings);
        }
    }

    /// Docks a free block on a face to which it can come (there is room), both it and the way it is turned drawn by these words.
    fn dock_one(
        &mut self,
        seat: usize,
        face: Face,
        [who, how]: [u32; 2],
        dockings: &mut Vec<Docking>,
    ) {
        let Some(cell) = self.seats[seat]
            .across(face)
            .filter(|_| self.free.len() > 0)
        else {
            return;
        };
        let pose = below(how, 24) as u8;
        let docking = Docking {
            site: BlockFace {
                body: self.body(seat),
                face,
            },
            child: self.free.select(below(who, self.free.len())) as u32,
            child_face: Face::ALL[usize::from(pose / 4)],
            turn: pose % 4,
            entries: 1,
            entered: self.tick,
        };
        self.dock(seat, face, cell, &docking);
        dockings.push(docking);
    }

    /// The block on a seat.
    fn body(&self, seat: usize) -> Body {
        match self.seeds.get(seat) {
            Some(&cell) => Body::Seed(cell),
            None => Body::Free((seat - self.seeds.len()) as u32),
        }
    }
}

/// The number of a face among all.
fn number(seat: usize, face: Face) -> usize {
    Face::ALL.len() * seat + face as usize
}

impl World for ShuffleWorld {
    fn tick(&self) -> u64 {
        self.tick
    }

    fn magnetize(&mut self, site: BlockFace) {
        let BlockFace { body, face } = site;
        let Some(seat) = self.seat(body) else {
            return;
        };
        let of = &mut self.seats[seat];
        if (of.on | of.holding) & bit(face) != 0 {
            return;
        }
        of.on |= bit(face) | WORKED;
        let way = of.orientation.to_structure(face);
        let from = of.cell;
        if let Some(cell) = of.across(face) {
            let content = self.grid.get_mut(cell);
            content.aimed |= bit(way);
            if content.block == NOBODY {
                self.open.insert(number(seat, face));
            }
        }
        self.expose(from);
    }

    fn switch_off(&mut self, site: BlockFace) {
        let Some(seat) = self.seat(site.body) else {
            return;
        };
        let mut going: SmallVec<[_; 8]> = smallvec![(seat, site.face)];
        while let Some((seat, face)) = going.pop() {
            self.close(seat, face);
            if let Some(child) = self.let_go(seat, face) {
                going.extend(Face::ALL.map(|face| (child, face)));
                self.expose(self.seats[child].cell);
            }
            self.expose(self.seats[seat].cell);
        }
    }

    fn plant(&mut self, site: BlockFace) -> Option<Docking> {
        self.magnetize(site);
        let BlockFace { body, face } = site;
        let seat = self.seat(body)?;
        let cell = self.target(seat, face)?;
        let last = self.free.len().checked_sub(1)?;
        let parent = self.seats[seat].orientation;
        let (child_face, turn) = Orientation::IDENTITY.as_docked(parent, face)?;
        let docking = Docking {
            site,
            child: self.free.select(last) as u32,
            child_face,
            turn,
            entries: 1,
            entered: self.tick,
        };
        self.dock(seat, face, cell, &docking);
        Some(docking)
    }

    fn largest_group(&self) -> u32 {
        self.groups.as_ref().map_or(1, Groups::largest)
    }

    fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault> {
        self.gather();
        self.stray(dockings);
        let [which, who, how, _] = self.draws.block(self.tick, 0);
        self.tick += 1;
        if self.open.len() > 0 {
            let site = self.open.select(below(which, self.open.len()));
            let (seat, face) = (site / Face::ALL.len(), Face::ALL[site % Face::ALL.len()]);
            self.dock_one(seat, face, [who, how], dockings);
        }
        Ok(())
    }
}
