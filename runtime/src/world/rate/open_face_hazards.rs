//! Open faces and the remaining hazard of each.
use std::collections::VecDeque;

use serde::{Deserialize, Serialize};
use stochc_estimate::{
    Neighbourhood, Rivals, SIGHT, Wait, feature_cells, reference_count, rivalry,
};
use stochc_ir::{Cell, Face};

use crate::world::grid::ChunkedGrid;
use crate::world::lattice::faces;

/// Index of an open face. It is reused after the face has closed.
pub(super) type Slot = u32;

/// Slot number that stands for no face.
const NOWHERE: Slot = Slot::MAX;

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct OpenFace {
    /// Index among all faces.
    pub number: usize,
    /// Cell of the block to be captured.
    pub cell: Cell,
    /// Direction from the capturing block to that cell.
    pub direction: Face,
    /// Occupancy around the cell.
    pub near: Neighbourhood,
    /// Tick when the face was opened.
    pub since: u64,
    /// Open faces nearby that compete for blocks.
    pub rivals: Rivals,
    /// Hazard that must still accumulate before the capture.
    left: f64,
    /// Current distribution of the waiting time. `None` until it is computed.
    wait: Option<Wait>,
    /// Hazard of `wait`, accumulated from the opening of the face to the last update of `wait`.
    before: f64,
    /// Upper bound of the capture time.
    latest: f64,
    /// Sequence number of the face's opening. 0 if the face is closed.
    opening: u64,
    /// Another face that is open to the same cell.
    next: Slot,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct OpenFaceHazards {
    faces: Vec<OpenFace>,
    /// Slots without a face, the longest vacant first. This order keeps faces that open close
    /// together near each other in memory.
    vacant: VecDeque<Slot>,
    /// Grid that marks the cells in front of open faces with the slot of the face.
    cells: ChunkedGrid<Slot>,
    /// Number of openings so far.
    opened: u64,
    /// Number of blocks that were free at the start.
    count: u32,
    /// Number of free blocks that the hazards are computed for, at least the current number.
    reference_count: u32,
}

impl OpenFace {
    /// Returns a newly opened face that captures when its hazard has accumulated to `left`.
    pub fn new(
        number: usize,
        (cell, direction): (Cell, Face),
        near: Neighbourhood,
        since: u64,
        left: f64,
    ) -> OpenFace {
        OpenFace {
            number,
            cell,
            direction,
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

    pub fn opening(&self) -> u64 {
        self.opening
    }

    pub fn latest(&self) -> f64 {
        self.latest
    }

    /// Removes faces of a cell from the rivals of this face. `directions` has one bit per
    /// direction. Returns whether there were any.
    fn drop_rivals(&mut self, cell: Cell, directions: u8) -> bool {
        let mut has_fewer = false;
        for direction in faces(directions) {
            if let Some(rivalry) = rivalry((self.cell, self.direction), (cell, direction)) {
                self.rivals.remove(rivalry);
                has_fewer = true;
            }
        }
        has_fewer
    }
}

impl OpenFaceHazards {
    /// Returns an empty set. `often` are the cells that are expected most often in front of open
    /// faces.
    pub fn new(count: u32, often: impl Iterator<Item = Cell>) -> OpenFaceHazards {
        OpenFaceHazards {
            faces: Vec::new(),
            vacant: VecDeque::new(),
            cells: ChunkedGrid::new(NOWHERE, often),
            opened: 0,
            count,
            reference_count: count,
        }
    }

    /// Adds a face and returns its slot. Adds the faces with new rivals, including this one, to
    /// `changed`.
    pub fn open(&mut self, mut face: OpenFace, changed: &mut Vec<Slot>) -> Slot {
        let this = (face.cell, face.direction);
        self.each_near(face.cell, 1, |slot, near| {
            let other = (near.cell, near.direction);
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

    /// Removes a face that is open to a cell and returns its former slot. The face still counts as
    /// a rival of others.
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

    /// Removes faces of a cell from the rivals of all other faces. `directions` has one bit per
    /// direction. Adds the affected faces to `changed`.
    pub fn drop_rivals(&mut self, cell: Cell, directions: u8, changed: &mut Vec<Slot>) {
        self.each_near(cell, 1, |slot, face| {
            if face.drop_rivals(cell, directions) {
                changed.push(slot);
            }
        });
    }

    /// Returns the face in a slot if it is open.
    pub fn face(&self, slot: Slot) -> Option<&OpenFace> {
        let face = self.faces.get(slot as usize);
        face.filter(|face| face.opening != 0)
    }

    /// Returns the face in a slot if `opening` is the number of its current opening.
    pub fn opening(&self, slot: Slot, opening: u64) -> Option<&OpenFace> {
        let face = self.faces.get(slot as usize);
        face.filter(|face| face.opening == opening)
    }

    /// Sorts slots by face index, and removes duplicates and closed faces.
    pub fn sort(&self, slots: &mut Vec<Slot>) {
        slots.retain(|slot| self.face(*slot).is_some());
        slots.sort_unstable_by_key(|slot| self.faces[*slot as usize].number);
        slots.dedup();
    }

    /// Returns the slots of all open faces, sorted by face index.
    pub fn all(&self) -> Vec<Slot> {
        let mut slots = (0..self.faces.len() as Slot).collect();
        self.sort(&mut slots);
        slots
    }

    /// Returns the slots of the open faces whose surroundings include a cell, sorted by face index.
    pub fn near(&mut self, cell: Cell) -> Vec<Slot> {
        let mut near = Vec::new();
        self.each_near(cell, SIGHT, |slot, _| near.push(slot));
        self.sort(&mut near);
        near
    }

    /// Marks a cell as occupied or empty and removes its faces [as
    /// rivals](OpenFaceHazards::drop_rivals). Adds the affected faces to `changed`.
    pub fn fill(&mut self, cell: Cell, is_full: bool, directions: u8, changed: &mut Vec<Slot>) {
        self.each_near(cell, SIGHT, |slot, face| {
            let offset = difference(cell, face.cell);
            face.near.set(offset, is_full);
            let has_fewer = face.drop_rivals(cell, directions);
            if has_fewer || feature_cells(face.direction).is_blocked(offset) {
                changed.push(slot);
            }
        });
    }

    /// Calls `show` with each open face whose cell is at most `steps` away along each axis.
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

    /// Sets the waiting-time distribution of a face from a tick on. Returns a lower bound of its
    /// capture time, or `None` if nothing changed.
    pub fn update(&mut self, slot: Slot, tick: u64, wait: Wait) -> Option<f64> {
        let face = self.faces.get_mut(slot as usize)?;
        if face.wait == Some(wait) {
            return None;
        }
        let age = (tick - face.since) as f64;
        face.before = match face.wait {
            Some(before) => {
                let [until_now, restarted] = Wait::cumulative_hazards([before, wait], age);
                face.left = (face.left - (until_now - face.before)).max(0.0);
                restarted
            }
            None => wait.cumulative_hazard(age),
        };
        face.wait = Some(wait);
        let (earliest, latest) = wait.time_bounds(face.left + face.before);
        face.latest = face.since as f64 + latest;
        Some(face.since as f64 + earliest)
    }

    /// Computes the exact capture time of the face in a slot.
    pub fn time(&mut self, slot: Slot) -> Option<f64> {
        let face = self.faces.get_mut(slot as usize)?;
        face.latest = face.since as f64 + face.wait?.time_of(face.left + face.before);
        Some(face.latest)
    }

    /// Continues the wait of a face whose capture was rejected. `left` is the new hazard to
    /// accumulate.
    pub fn continue_wait(&mut self, slot: Slot, left: f64) {
        if let Some(face) = self.faces.get_mut(slot as usize) {
            face.left = left;
            face.wait = None;
        }
    }

    /// Returns the number of free blocks that hazards are computed for, as a fraction of those at
    /// the start.
    pub fn part(&self) -> f64 {
        self.part_of(self.reference_count)
    }

    /// Returns this number of blocks as a fraction of those free at the start.
    pub fn part_of(&self, blocks: u32) -> f64 {
        f64::from(blocks) / f64::from(self.count.max(1))
    }

    /// Sets the number of blocks in the hazards to `free`, if `free` is larger or less than half as
    /// large. Returns whether the number was set.
    pub fn follow(&mut self, free: u32) -> bool {
        let before = self.reference_count;
        self.reference_count = reference_count(before, free);
        self.reference_count != before
    }
}

/// Returns the offset from one cell to another nearby.
fn difference(to: Cell, from: Cell) -> [i32; 3] {
    [to.x - from.x, to.y - from.y, to.z - from.z]
}
