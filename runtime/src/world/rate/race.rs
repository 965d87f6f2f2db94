//! The faces that are open, each with the hazard that it has still to use up.
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use stochc_ir::{Cell, Face};
use stochc_rates::{Neighbourhood, Rivals, SIGHT, Wait, feature_cells, rivalry};

/// Sides of the cubes of cells by which open faces are found.
const CUBE: i32 = 8;

/// Where an open face is kept. Another one may be there later.
pub(super) type Slot = u32;

/// Slots, in no order.
pub(super) type Slots = SmallVec<[Slot; 32]>;

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
    /// What it waits for, and until when; `None`: nobody has said.
    wait: Option<Wait>,
    until: f64,
    /// The hazard of `wait` from the beginning to the tick in which it was said.
    before: f64,
    /// Which opening of all it is; 0: it is closed.
    opening: u64,
}

/// All of them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Race {
    faces: Vec<OpenFace>,
    vacant: Vec<Slot>,
    /// The slot of each open face, by its number.
    slots: FxHashMap<usize, Slot>,
    /// The open faces of each cube of cells.
    cubes: FxHashMap<[i32; 3], SmallVec<[Place; 2]>>,
    /// Openings so far.
    opened: u64,
    /// Blocks that were free at the beginning.
    count: u32,
    /// Blocks that hazards are meant for: at least those that are free.
    meant_for: u32,
}

/// Where an open face is, beside its slot.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Place {
    cell: Cell,
    way: Face,
    slot: Slot,
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
            until: f64::INFINITY,
            before: 0.0,
            opening: 0,
        }
    }

    /// Which opening of all it is.
    pub fn opening(&self) -> u64 {
        self.opening
    }
}

impl Race {
    pub fn new(count: u32) -> Race {
        Race {
            faces: Vec::new(),
            vacant: Vec::new(),
            slots: FxHashMap::default(),
            cubes: FxHashMap::default(),
            opened: 0,
            count,
            meant_for: count,
        }
    }

    /// Adds a face: its slot. Those that have another rival now are added to `changed`, as it is.
    pub fn open(&mut self, face: OpenFace, changed: &mut Slots) -> Slot {
        let (cell, way) = (face.cell, face.way);
        let mut rivals = Rivals::default();
        for near in self.touching(cell) {
            let (this, other) = ((cell, way), (near.cell, near.way));
            if let Some(rivalry) = rivalry(this, other) {
                rivals.add(rivalry);
            }
            if let Some(rivalry) = rivalry(other, this) {
                self.faces[near.slot as usize].rivals.add(rivalry);
                changed.push(near.slot);
            }
        }
        self.opened += 1;
        let face = OpenFace {
            opening: self.opened,
            rivals,
            ..face
        };
        let slot = match self.vacant.pop() {
            Some(slot) => {
                self.faces[slot as usize] = face;
                slot
            }
            None => {
                self.faces.push(face);
                (self.faces.len() - 1) as Slot
            }
        };
        self.slots.insert(face.number, slot);
        let there = self.cubes.entry(cube(cell)).or_default();
        there.push(Place { cell, way, slot });
        changed.push(slot);
        slot
    }

    /// Takes a face out, if it is there. Those that it was a rival of are added to `changed`.
    pub fn close(&mut self, number: usize, changed: &mut Slots) {
        let Some(slot) = self.slots.remove(&number) else {
            return;
        };
        let face = &mut self.faces[slot as usize];
        face.opening = 0;
        let (cell, way) = (face.cell, face.way);
        self.vacant.push(slot);
        if let Some(there) = self.cubes.get_mut(&cube(cell)) {
            there.retain(|place| place.slot != slot);
            if there.is_empty() {
                self.cubes.remove(&cube(cell));
            }
        }
        for near in self.touching(cell) {
            if let Some(rivalry) = rivalry((near.cell, near.way), (cell, way)) {
                self.faces[near.slot as usize].rivals.remove(rivalry);
                changed.push(near.slot);
            }
        }
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
    pub fn sort(&self, slots: &mut Slots) {
        slots.retain(|slot| self.face(*slot).is_some());
        slots.sort_unstable_by_key(|slot| self.faces[*slot as usize].number);
        slots.dedup();
    }

    /// All open faces, in the order of their numbers.
    pub fn all(&self) -> Slots {
        let mut slots = self.slots.values().copied().collect();
        self.sort(&mut slots);
        slots
    }

    /// The open faces to which a cell matters, in the order of their numbers.
    pub fn near(&self, cell: Cell) -> Slots {
        let mut near = Slots::new();
        self.each_within(cell, [SIGHT; 3], |place| near.push(place.slot));
        self.sort(&mut near);
        near
    }

    /// A cell is full now, or empty: those of whose surroundings the law sees it are added to `changed`.
    pub fn fill(&mut self, cell: Cell, is_full: bool, changed: &mut Slots) {
        let mut near = Slots::new();
        self.each_within(cell, [SIGHT; 3], |place| near.push(place.slot));
        for slot in near {
            let face = &mut self.faces[slot as usize];
            let offset = difference(cell, face.cell);
            face.near.set(offset, is_full);
            if feature_cells(face.way).is_blocked(offset) {
                changed.push(slot);
            }
        }
    }

    /// The open faces to the cells that touch one.
    fn touching(&self, cell: Cell) -> SmallVec<[Place; 8]> {
        let mut near = SmallVec::new();
        self.each_within(cell, [1; 3], |place| near.push(*place));
        near
    }

    /// Shows the open faces to cells that are no farther along each axis than `steps`.
    fn each_within(&self, cell: Cell, steps: [i32; 3], mut show: impl FnMut(&Place)) {
        let centre = [cell.x, cell.y, cell.z];
        let low: [i32; 3] = std::array::from_fn(|axis| centre[axis].saturating_sub(steps[axis]));
        let high: [i32; 3] = std::array::from_fn(|axis| centre[axis].saturating_add(steps[axis]));
        let cubes = |axis: usize| low[axis].div_euclid(CUBE)..=high[axis].div_euclid(CUBE);
        for x in cubes(0) {
            for y in cubes(1) {
                for z in cubes(2) {
                    for place in self.cubes.get(&[x, y, z]).into_iter().flatten() {
                        let at = [place.cell.x, place.cell.y, place.cell.z];
                        if (0..3).all(|axis| (low[axis]..=high[axis]).contains(&at[axis])) {
                            show(place);
                        }
                    }
                }
            }
        }
    }

    /// A face has another wait from a tick on: when it captures; `None`: that is as it was.
    pub fn update(&mut self, slot: Slot, tick: u64, wait: Wait) -> Option<f64> {
        let face = self.faces.get_mut(slot as usize)?;
        if face.wait == Some(wait) {
            return None;
        }
        let age = (tick - face.since) as f64;
        if let Some(before) = face.wait {
            let used = before.cumulative_hazard(age) - face.before;
            face.left = (face.left - used).max(0.0);
        }
        face.wait = Some(wait);
        face.before = wait.cumulative_hazard(age);
        face.until = face.since as f64 + wait.time_of(face.left + face.before);
        Some(face.until)
    }

    /// A face that could have captured goes on, with another hazard to sum up from now on.
    pub fn go_on(&mut self, slot: Slot, left: f64) {
        if let Some(face) = self.faces.get_mut(slot as usize) {
            face.left = left;
            face.wait = None;
        }
    }

    /// Whether a face still captures at the time that was said.
    pub fn holds(&self, slot: Slot, opening: u64, time: f64) -> bool {
        let face = self.opening(slot, opening);
        face.is_some_and(|face| face.until == time)
    }

    /// The part of the blocks that hazards are meant for.
    pub fn part(&self) -> f64 {
        f64::from(self.meant_for) / f64::from(self.count.max(1))
    }

    /// The part of what hazards are meant for that is free.
    pub fn share(&self, free: u32) -> f64 {
        f64::from(free) / f64::from(self.meant_for.max(1))
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

fn cube(cell: Cell) -> [i32; 3] {
    [cell.x, cell.y, cell.z].map(|part| part.div_euclid(CUBE))
}
