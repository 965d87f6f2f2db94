//! The faces that are open, each with the hazard that it has still to use up.
use std::collections::VecDeque;

use serde::{Deserialize, Serialize};
use stochc_ir::{Cell, Face};
use stochc_rates::{Neighbourhood, Rivals, SIGHT, Wait, feature_cells, rivalry};

use crate::world::grid::ChunkedGrid;
use crate::world::lattice::faces;

/// Where an open face is kept. Another one may be there later.
pub(super) type Slot = u32;

/// The slot of no face.
const NOWHERE: Slot = Slot::MAX;

/// A face that is open.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct OpenFace {
    /// Its number among all faces.
    pub number: usize,
    /// Where the captured block will sit.
    pub cell: Cell,
    /// The way there from the block that captures.
    pub way: Face,
    /// What is around the cell.
    pub near: Neighbourhood,
    /// The tick since when it is open.
    pub since: u64,
    /// Faces that wait near it.
    pub rivals: Rivals,
    /// The hazard that it may still sum up before it captures.
    left: f64,
    /// What it waits for; `None`: nobody has said.
    wait: Option<Wait>,
    /// The hazard of `wait` from the beginning to the tick in which it was said.
    before: f64,
    /// When it captures at the latest.
    latest: f64,
    /// Which opening of all it is; 0: it is closed.
    opening: u64,
    /// Another face that is open to the same cell.
    next: Slot,
}

/// All of them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct OpenFaceHazards {
    faces: Vec<OpenFace>,
    /// Slots without a face. That which has been so for longest comes first: faces that open as others close, one after
    /// the other, stay near those that they were near.
    vacant: VecDeque<Slot>,
    /// Cells to which a face is open are marked, and have its slot.
    cells: ChunkedGrid<Slot>,
    /// Openings so far.
    opened: u64,
    /// Blocks that were free at the beginning.
    count: u32,
    /// Blocks that hazards are meant for: at least those that are free.
    meant_for: u32,
}

impl OpenFace {
    /// A face that begins to wait, and captures when its hazard has summed up to `left`.
    pub fn new(
        number: usize,
        (cell, way): (Cell, Face),
        near: Neighbourhood,
        since: u64,
        left: f64,
    ) -> OpenFace {
        OpenFace {
            number,
            cell,
            way,
            near,
            since,
            rivals: Rivals::default(),
            left,
            wait: None,
            before: 0.0,
            latest: f64::INFINITY,
            opening: 0,
            next: NOWHERE,
        }
    }

    /// Which opening of all it is.
    pub fn opening(&self) -> u64 {
        self.opening
    }

    /// When it captures at the latest.
    pub fn latest(&self) -> f64 {
        self.latest
    }

    /// Faces that were open to a cell are rivals no more: whether one was.
    fn drop_rivals(&mut self, cell: Cell, ways: u8) -> bool {
        let mut has_fewer = false;
        for way in faces(ways) {
            if let Some(rivalry) = rivalry((self.cell, self.way), (cell, way)) {
                self.rivals.remove(rivalry);
                has_fewer = true;
            }
        }
        has_fewer
    }
}

impl OpenFaceHazards {
    /// No face is open; those to these cells will be most often.
    pub fn new(count: u32, often: impl Iterator<Item = Cell>) -> OpenFaceHazards {
        OpenFaceHazards {
            faces: Vec::new(),
            vacant: VecDeque::new(),
            cells: ChunkedGrid::new(NOWHERE, often),
            opened: 0,
            count,
            meant_for: count,
        }
    }

    /// Adds a face: its slot. Those that have another rival now are added to `changed`, as it is.
    pub fn open(&mut self, mut face: OpenFace, changed: &mut Vec<Slot>) -> Slot {
        let this = (face.cell, face.way);
        self.each_near(face.cell, 1, |slot, near| {
            let other = (near.cell, near.way);
            if let Some(rivalry) = rivalry(this, other) {
                face.rivals.add(rivalry);
            }
            if let Some(rivalry) = rivalry(other, this) {
                near.rivals.add(rivalry);
                changed.push(slot);
            }
        });
        self.opened += 1;
        face.opening = self.opened;
        let slot = self.vacant.pop_front().unwrap_or_else(|| {
            self.faces.push(face);
            (self.faces.len() - 1) as Slot
        });
        let first = self.cells.mark(face.cell, true);
        face.next = std::mem::replace(first, slot);
        self.faces[slot as usize] = face;
        changed.push(slot);
        slot
    }

    /// Takes the face of a number that is open to a cell out, if it is there: the slot where it was. It still counts as a rival.
    pub fn close(&mut self, number: usize, cell: Cell) -> Option<Slot> {
        let (mut slot, mut before) = (self.cells.get(cell), None);
        while self.faces.get(slot as usize)?.number != number {
            before = Some(slot);
            slot = self.faces[slot as usize].next;
        }
        let face = &mut self.faces[slot as usize];
        face.opening = 0;
        let next = face.next;
        self.vacant.push_back(slot);
        match before {
            Some(before) => self.faces[before as usize].next = next,
            None => *self.cells.mark(cell, next != NOWHERE) = next,
        }
        Some(slot)
    }

    /// Faces that were open to a cell, one bit for each of their directions, are rivals no more. Those that they were rivals of are
    /// added to `changed`.
    pub fn drop_rivals(&mut self, cell: Cell, ways: u8, changed: &mut Vec<Slot>) {
        self.each_near(cell, 1, |slot, face| {
            if face.drop_rivals(cell, ways) {
                changed.push(slot);
            }
        });
    }

    /// The face in a slot, if it is open.
    pub fn face(&self, slot: Slot) -> Option<&OpenFace> {
        let face = self.faces.get(slot as usize);
        face.filter(|face| face.opening != 0)
    }

    /// The same, if this is still the opening that was meant.
    pub fn opening(&self, slot: Slot, opening: u64) -> Option<&OpenFace> {
        let face = self.faces.get(slot as usize);
        face.filter(|face| face.opening == opening)
    }

    /// Puts slots into the order of their faces' numbers, each once, and leaves those out that are not open.
    pub fn sort(&self, slots: &mut Vec<Slot>) {
        slots.retain(|slot| self.face(*slot).is_some());
        slots.sort_unstable_by_key(|slot| self.faces[*slot as usize].number);
        slots.dedup();
    }

    /// All open faces, in the order of their numbers.
    pub fn all(&self) -> Vec<Slot> {
        let mut slots = (0..self.faces.len() as Slot).collect();
        self.sort(&mut slots);
        slots
    }

    /// The open faces to which a cell matters, in the order of their numbers.
    pub fn near(&mut self, cell: Cell) -> Vec<Slot> {
        let mut near = Vec::new();
        self.each_near(cell, SIGHT, |slot, _| near.push(slot));
        self.sort(&mut near);
        near
    }

    /// A cell is full now, or empty, and [faces that were open to it](OpenFaceHazards::drop_rivals) are so no more. Those of whose surroundings
    /// the law sees something of that are added to `changed`.
    pub fn fill(&mut self, cell: Cell, is_full: bool, ways: u8, changed: &mut Vec<Slot>) {
        self.each_near(cell, SIGHT, |slot, face| {
            let offset = difference(cell, face.cell);
            face.near.set(offset, is_full);
            let has_fewer = face.drop_rivals(cell, ways);
            if has_fewer || feature_cells(face.way).is_blocked(offset) {
                changed.push(slot);
            }
        });
    }

    /// Shows the open faces to cells that are no farther along each axis than `steps`.
    #[inline]
    fn each_near(&mut self, cell: Cell, steps: i32, mut show: impl FnMut(Slot, &mut OpenFace)) {
        let faces = &mut self.faces;
        self.cells.each_marked_near(cell, steps, |_, first| {
            let mut slot = first;
            while let Some(face) = faces.get_mut(slot as usize) {
                show(slot, face);
                slot = face.next;
            }
        });
    }

    /// A face has another wait from a tick on: when it captures at the earliest; `None`: that is as it was.
    pub fn update(&mut self, slot: Slot, tick: u64, wait: Wait) -> Option<f64> {
        let face = self.faces.get_mut(slot as usize)?;
        if face.wait == Some(wait) {
            return None;
        }
        let age = (tick - face.since) as f64;
        face.before = match face.wait {
            Some(before) => {
                let [until_now, anew] = Wait::cumulative_hazards([before, wait], age);
                face.left = (face.left - (until_now - face.before)).max(0.0);
                anew
            }
            None => wait.cumulative_hazard(age),
        };
        face.wait = Some(wait);
        let (earliest, latest) = wait.time_bounds(face.left + face.before);
        face.latest = face.since as f64 + latest;
        Some(face.since as f64 + earliest)
    }

    /// When the face in a slot captures, exactly.
    pub fn time(&mut self, slot: Slot) -> Option<f64> {
        let face = self.faces.get_mut(slot as usize)?;
        face.latest = face.since as f64 + face.wait?.time_of(face.left + face.before);
        Some(face.latest)
    }

    /// A face that could have captured goes on, with another hazard to sum up from now on.
    pub fn go_on(&mut self, slot: Slot, left: f64) {
        if let Some(face) = self.faces.get_mut(slot as usize) {
            face.left = left;
            face.wait = None;
        }
    }

    /// The part of the blocks that hazards are meant for.
    pub fn part(&self) -> f64 {
        self.part_of(self.meant_for)
    }

    /// The part of the blocks that so many are.
    pub fn part_of(&self, blocks: u32) -> f64 {
        f64::from(blocks) / f64::from(self.count.max(1))
    }

    /// So many blocks are free now: whether hazards are meant for another number from now on.
    pub fn follow(&mut self, free: u32) -> bool {
        if free <= self.meant_for && self.meant_for / 2 <= free {
            return false;
        }
        self.meant_for = free;
        true
    }
}

/// The way from one cell to another that is near.
fn difference(to: Cell, from: Cell) -> [i32; 3] {
    [to.x - from.x, to.y - from.y, to.z - from.z]
}
