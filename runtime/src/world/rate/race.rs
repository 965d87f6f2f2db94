//! The faces that are open, each with the hazard that it has still to use up.
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};
use smallvec::SmallVec;
use stochc_ir::{Cell, Face};
use stochc_rates::{SIGHT, Wait, sees};

/// Sides of the cubes of cells by which open faces are found.
const CUBE: i32 = 4;

/// A face that is open.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct OpenFace {
    /// Where the captured block will sit.
    pub cell: Cell,
    /// The way there from the block that captures.
    pub way: Face,
    /// The tick since when it is open.
    pub since: u64,
    /// The hazard that it may still sum up before it captures.
    left: f64,
    /// What it waits for since `seen`, and until when; `None`: nobody has said.
    wait: Option<Wait>,
    seen: u64,
    until: f64,
    opening: u64,
}

/// All of them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Race {
    faces: FxHashMap<usize, OpenFace>,
    /// The open faces of each cube of cells.
    cubes: FxHashMap<[i32; 3], SmallVec<[usize; 4]>>,
    /// Openings so far.
    opened: u64,
    /// Blocks that were free at the beginning.
    count: u32,
    /// Blocks that hazards are meant for: at least those that are free.
    meant_for: u32,
}

impl OpenFace {
    /// A face that begins to wait, and captures when its hazard has summed up to `left`.
    pub fn new(cell: Cell, way: Face, since: u64, left: f64) -> OpenFace {
        OpenFace {
            cell,
            way,
            since,
            left,
            wait: None,
            seen: since,
            until: f64::INFINITY,
            opening: 0,
        }
    }
}

impl Race {
    pub fn new(count: u32) -> Race {
        Race {
            faces: FxHashMap::default(),
            cubes: FxHashMap::default(),
            opened: 0,
            count,
            meant_for: count,
        }
    }

    /// Adds a face: the number of its opening.
    pub fn open(&mut self, number: usize, face: OpenFace) -> u64 {
        self.opened += 1;
        let opening = self.opened;
        self.cubes.entry(cube(face.cell)).or_default().push(number);
        self.faces.insert(number, OpenFace { opening, ..face });
        opening
    }

    pub fn close(&mut self, number: usize) {
        if let Some(face) = self.faces.remove(&number)
            && let Some(there) = self.cubes.get_mut(&cube(face.cell))
        {
            there.retain(|other| *other != number);
            if there.is_empty() {
                self.cubes.remove(&cube(face.cell));
            }
        }
    }

    pub fn face(&self, number: usize) -> Option<&OpenFace> {
        self.faces.get(&number)
    }

    /// The numbers of all open faces, in rising order.
    pub fn faces(&self) -> Vec<usize> {
        let mut numbers: Vec<usize> = self.faces.keys().copied().collect();
        numbers.sort_unstable();
        numbers
    }

    /// The open faces to which a cell matters, in rising order.
    pub fn near(&self, cell: Cell) -> Vec<usize> {
        let mut near: Vec<usize> = Vec::new();
        let from = cube(Cell::new(
            cell.x.saturating_sub(SIGHT),
            cell.y.saturating_sub(SIGHT),
            cell.z.saturating_sub(SIGHT),
        ));
        let to = cube(Cell::new(
            cell.x.saturating_add(SIGHT),
            cell.y.saturating_add(SIGHT),
            cell.z.saturating_add(SIGHT),
        ));
        for x in from[0]..=to[0] {
            for y in from[1]..=to[1] {
                for z in from[2]..=to[2] {
                    near.extend(self.cubes.get(&[x, y, z]).into_iter().flatten());
                }
            }
        }
        near.retain(|number| (self.faces.get(number)).is_some_and(|face| sees(face.cell, cell)));
        near.sort_unstable();
        near
    }

    /// [`Race::near`], each with its opening and its cell.
    pub fn near_with_openings(&self, cell: Cell) -> Vec<(usize, u64, Cell)> {
        let near = self.near(cell).into_iter();
        near.filter_map(|number| {
            let face = self.faces.get(&number)?;
            Some((number, face.opening, face.cell))
        })
        .collect()
    }

    /// Whether a face is open towards a cell in a direction.
    pub fn is_open(&self, cell: Cell, way: Face) -> bool {
        let there = self.cubes.get(&cube(cell)).into_iter().flatten();
        there
            .filter_map(|number| self.faces.get(number))
            .any(|face| face.cell == cell && face.way == way)
    }

    /// A face has another wait from a tick on: when it captures, and its opening; `None`: that is as it was.
    pub fn update(&mut self, number: usize, tick: u64, wait: Wait) -> Option<(f64, u64)> {
        let face = self.faces.get_mut(&number)?;
        if face.wait == Some(wait) {
            return None;
        }
        let age = |at: u64| (at - face.since) as f64;
        if let Some(before) = face.wait {
            let used =
                before.cumulative_hazard(age(tick)) - before.cumulative_hazard(age(face.seen));
            face.left = (face.left - used).max(0.0);
        }
        let used = wait.cumulative_hazard(age(tick));
        face.wait = Some(wait);
        face.seen = tick;
        face.until = face.since as f64 + wait.time_of(face.left + used);
        Some((face.until, face.opening))
    }

    /// A face that could have captured goes on, with another hazard to sum up from its time on.
    pub fn go_on(&mut self, number: usize, left: f64) {
        if let Some(face) = self.faces.get_mut(&number) {
            face.seen = face.until.ceil() as u64;
            face.left = left;
            face.wait = None;
        }
    }

    pub fn is_same_opening(&self, number: usize, opening: u64) -> bool {
        self.faces
            .get(&number)
            .is_some_and(|face| face.opening == opening)
    }

    /// Whether a face still captures at the time that was said.
    pub fn holds(&self, number: usize, opening: u64, time: f64) -> bool {
        let face = self.faces.get(&number);
        face.is_some_and(|face| face.opening == opening && face.until == time)
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

fn cube(cell: Cell) -> [i32; 3] {
    [cell.x, cell.y, cell.z].map(|part| part.div_euclid(CUBE))
}
