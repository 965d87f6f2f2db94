//! Target structure and plate.
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::VecDeque;

use stochc_ir::scene::{Planar, PlanarAccess, PlanarArea, Scene};
use stochc_ir::table::Plate;
use stochc_ir::{Cell, Face};

use crate::target::error::{LoosePart, TargetError};
use crate::target::limits::{FARTHEST, MAX_CELLS};

/// Largest number of cells visited in the search for one bridge, and in all searches of a target.
const MAX_BRIDGE_STEPS: usize = 200_000;
const MAX_STEPS_OF_ALL: usize = 2_000_000;

/// Buildable structure: every cell is connected to a capturing block of the plate or to an existing
/// block.
#[derive(Clone, Debug)]
pub struct Target {
    /// Cells, sorted and unique, with z at least 1.
    cells: Vec<Cell>,
    /// Existing blocks, sorted by cell.
    existing: Vec<ExistingBlock>,
    /// Blocks released before the first capture, sorted by cell.
    released: Vec<ExistingBlock>,
    plate: Plate,
    /// Blocks of the plate that may capture, sorted. `None` if all may.
    seeds: Option<Vec<(i32, i32)>>,
    /// Whether the first captures begin with the run, when the free blocks are at rest.
    is_at_rest: bool,
    /// Area of a planar world. Its existing blocks are the seeds, and `seeds` is empty.
    plane: Option<PlanarAccess>,
}

/// Block that exists before the first capture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ExistingBlock {
    /// Cell of the block.
    pub cell: Cell,
    /// Direction from the parent.
    pub direction: Face,
    /// Whether the block can capture others.
    pub can_capture: bool,
}

impl Target {
    /// Returns a target on a plate. `seeds` are the positions (x, y) of capturing blocks, or all if
    /// `None`. `free` is the number of free blocks.
    ///
    /// # Errors
    ///
    /// If the target is invalid. The error lists all cells concerned.
    pub fn new(
        cells: Vec<Cell>,
        plate: Plate,
        seeds: Option<Vec<(i32, i32)>>,
        free: u32,
    ) -> Result<Target, TargetError> {
        Target::with_existing(cells, (Vec::new(), Vec::new()), plate, seeds, free)
    }

    /// Returns a target with existing blocks, which count as used free blocks, and with blocks to
    /// release first. Existing blocks are added to `cells`.
    ///
    /// # Errors
    ///
    /// As [`Target::new`], and if no cell is missing.
    pub(crate) fn with_existing(
        mut cells: Vec<Cell>,
        (mut existing, mut released): (Vec<ExistingBlock>, Vec<ExistingBlock>),
        plate: Plate,
        seeds: Option<Vec<(i32, i32)>>,
        free: u32,
    ) -> Result<Target, TargetError> {
        existing.sort_unstable();
        existing.dedup_by_key(|block| block.cell);
        released.sort_unstable();
        cells.extend(existing.iter().map(|block| block.cell));
        cells.sort_unstable();
        cells.dedup();
        if cells.len() == existing.len() {
            return Err(TargetError::Empty);
        }
        let is_far = |cell: &&Cell| {
            let Cell { x, y, z } = **cell;
            [x, y, z]
                .iter()
                .any(|at| !(-FARTHEST..=FARTHEST).contains(at))
        };
        if let Some(&cell) = cells.iter().find(is_far) {
            return Err(TargetError::TooFar(cell));
        }
        let below: Vec<Cell> = cells.iter().filter(|cell| cell.z < 1).copied().collect();
        if !below.is_empty() {
            return Err(TargetError::BelowPlate(below));
        }
        if cells.len() > MAX_CELLS.min(free as usize) {
            let needed = cells.len();
            return Err(TargetError::TooFewBlocks { needed, free });
        }
        let seeds = seeds.map(|mut seeds| {
            seeds.sort_unstable();
            seeds.dedup();
            seeds
        });
        let target = Target {
            cells,
            existing,
            is_at_rest: released.is_empty(),
            released,
            plate,
            seeds,
            plane: None,
        };
        match target.loose() {
            parts if parts.is_empty() => Ok(target),
            parts => Err(TargetError::Loose(parts)),
        }
    }

    /// Returns a target in the planar world of a scene. Its seeds are blocks among the cells.
    ///
    /// # Errors
    ///
    /// As [`Target::new`], and if there are no seeds, or a cell is not a free cell of the plane.
    pub(crate) fn in_plane(
        cells: Vec<Cell>,
        scene: &Scene,
        plate: Plate,
        seeds: Option<Vec<(i32, i32)>>,
        free: u32,
    ) -> Result<Target, TargetError> {
        let seeds = seeds.ok_or(TargetError::NoSeeds)?;
        let seeds: FxHashSet<Cell> = (seeds.into_iter())
            .map(|(x, y)| Cell::new(x, y, Planar::LAYER))
            .collect();
        let is_free = |cell: &Cell| cell.z == Planar::LAYER && !seeds.contains(cell);
        let taken: Vec<Cell> = cells
            .iter()
            .filter(|cell| !is_free(cell))
            .copied()
            .collect();
        if !taken.is_empty() {
            return Err(TargetError::NotInPlane(taken));
        }
        let area = PlanarArea::from_scene(scene, &plate);
        let existing = seeds.iter().map(|&cell| ExistingBlock {
            cell,
            // Seeds have no parent.
            direction: Face::Up,
            can_capture: true,
        });
        let existing: Vec<ExistingBlock> = existing.collect();
        // Seeds are cells of the target, but not free blocks.
        let count = existing.len();
        let all = free.saturating_add(count as u32);
        let target =
            Target::with_existing(cells, (existing, Vec::new()), plate, Some(Vec::new()), all);
        let target = target.map_err(|error| match error {
            TargetError::TooFewBlocks { needed, .. } => TargetError::TooFewBlocks {
                needed: needed - count,
                free,
            },
            other => other,
        })?;
        let plane = area.map(|area| area.access(&target.cells));
        Ok(Target { plane, ..target })
    }

    /// Returns the area of a planar world, or `None` in space.
    pub(crate) fn plane(&self) -> Option<&PlanarAccess> {
        self.plane.as_ref()
    }

    /// Returns a target with other cells on the same plate, or `None` if it is invalid.
    pub(crate) fn with_cells(&self, cells: Vec<Cell>, free: u32) -> Option<Target> {
        Target::new(cells, self.plate.clone(), self.seeds.clone(), free).ok()
    }

    /// Returns the target for use after other captures.
    #[must_use]
    pub(crate) fn behind_others(self) -> Target {
        Target {
            is_at_rest: false,
            ..self
        }
    }

    pub(crate) fn is_at_rest(&self) -> bool {
        self.is_at_rest
    }

    /// Returns the cells, sorted.
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// Returns the existing blocks, sorted by cell.
    pub fn existing(&self) -> &[ExistingBlock] {
        &self.existing
    }

    /// Returns the blocks released before the first capture, sorted by cell.
    pub fn released(&self) -> &[ExistingBlock] {
        &self.released
    }

    pub(crate) fn existing_at(&self, cell: Cell) -> Option<&ExistingBlock> {
        let at = self
            .existing
            .binary_search_by_key(&cell, |block| block.cell);
        at.ok().map(|at| &self.existing[at])
    }

    /// Returns whether the block in a cell cannot hold others.
    fn is_inert(&self, cell: Cell) -> bool {
        self.existing_at(cell)
            .is_some_and(|block| !block.can_capture)
    }

    /// Returns the plate.
    pub fn plate(&self) -> &Plate {
        &self.plate
    }

    /// Returns whether a capturing block of the plate is under a cell.
    pub(crate) fn is_on_seed(&self, cell: Cell) -> bool {
        cell.z == 1 && self.has_seed(cell.x, cell.y)
    }

    fn has_seed(&self, x: i32, y: i32) -> bool {
        match &self.seeds {
            Some(seeds) => seeds.binary_search(&(x, y)).is_ok(),
            None => {
                let on = |at: i32, edge: u32| u32::try_from(at).is_ok_and(|at| at < edge);
                on(x, self.plate.width) && on(y, self.plate.depth)
            }
        }
    }

    /// Returns the parts that are attached to no seed, each with its bridge. Assumes that the
    /// bridges of earlier parts exist.
    fn loose(&self) -> Vec<LoosePart> {
        let mut all: FxHashSet<Cell> = self.cells.iter().copied().collect();
        let mut open: Vec<Cell> = self.cells.to_vec();
        let stands = |cell: &Cell| self.existing_at(*cell).is_some();
        let mut held: FxHashSet<Cell> = open.iter().copied().filter(stands).collect();
        open.retain(|&cell| {
            !self.is_inert(cell) && (self.is_on_seed(cell) || held.contains(&cell))
        });
        held.extend(&open);
        spread(&mut open, &all, &mut held);
        let mut left = MAX_STEPS_OF_ALL;
        // The seeds of a planar world are existing blocks.
        let has_plate = (self.seeds.as_ref()).is_none_or(|seeds| !seeds.is_empty());
        let mut parts = Vec::new();
        for cells in self.parts_beside(&held, &all) {
            let bridge = self.bridge(&cells, &held, &mut left);
            if let Some(bridge) = &bridge {
                let mut open: Vec<Cell> = cells.iter().chain(bridge).copied().collect();
                all.extend(bridge);
                held.extend(&open);
                spread(&mut open, &all, &mut held);
            }
            parts.push(LoosePart {
                rests_on_plate: has_plate && cells.iter().any(|cell| cell.z == 1),
                cells,
                bridge,
            });
        }
        parts
    }

    /// Returns the connected parts of the cells that are not in `held`, each sorted.
    fn parts_beside(&self, held: &FxHashSet<Cell>, all: &FxHashSet<Cell>) -> Vec<Vec<Cell>> {
        let mut seen = held.clone();
        let mut parts = Vec::new();
        for &cell in &self.cells {
            if seen.insert(cell) {
                let mut part = vec![cell];
                let mut next = 0;
                while let Some(&at) = part.get(next) {
                    next += 1;
                    let beside = Face::ALL.into_iter().filter_map(|face| at.across(face));
                    part.extend(beside.filter(|cell| all.contains(cell) && seen.insert(*cell)));
                }
                part.sort_unstable();
                parts.push(part);
            }
        }
        parts
    }

    /// Returns the fewest cells that connect a part with the rest or with a seed. Returns `None` if there are
    /// none, or no steps are `left`.
    fn bridge(&self, part: &[Cell], held: &FxHashSet<Cell>, left: &mut usize) -> Option<Vec<Cell>> {
        let mut from: FxHashMap<Cell, (Cell, usize)> =
            part.iter().map(|&cell| (cell, (cell, 0))).collect();
        let mut open: VecDeque<(Cell, usize)> = part.iter().map(|&cell| (cell, 0)).collect();
        while let Some((at, more)) = open.pop_front() {
            if from[&at].1 < more {
                // Reached earlier with fewer cells.
                continue;
            }
            let touches = |next: Cell| held.contains(&next) && !self.is_inert(next);
            let is_there = self.is_on_seed(at)
                || Face::ALL
                    .into_iter()
                    .filter_map(|face| at.across(face))
                    .any(touches);
            if is_there {
                let mut bridge = Vec::new();
                let mut here = at;
                while from[&here].0 != here {
                    bridge.push(here);
                    here = from[&here].0;
                }
                // Cells of other parts on the way exist anyway.
                bridge.retain(|cell| self.cells.binary_search(cell).is_err());
                bridge.sort_unstable();
                return Some(bridge);
            }
            if from.len() > MAX_BRIDGE_STEPS {
                return None;
            }
            for next in Face::ALL.into_iter().filter_map(|face| at.across(face)) {
                // Existing blocks that hold nothing cannot be part of a bridge.
                let is_part = self.cells.binary_search(&next).is_ok();
                let more = more + usize::from(!is_part);
                let is_shorter = from.get(&next).is_none_or(|known| more < known.1);
                if next.z >= 1 && is_shorter && !self.is_inert(next) {
                    *left = left.checked_sub(1)?;
                    from.insert(next, (at, more));
                    if is_part {
                        open.push_front((next, more))
                    } else {
                        open.push_back((next, more))
                    }
                }
            }
        }
        None
    }
}

/// Returns the cells that a plate holds as a target, if there are any.
#[cfg(test)]
pub fn held(cells: Vec<Cell>, plate: &Plate) -> Option<Target> {
    let target = |cells: Vec<Cell>| Target::new(cells, plate.clone(), None, u32::MAX);
    match target(cells.clone()) {
        Err(TargetError::Loose(parts)) => {
            let loose: FxHashSet<Cell> = parts.into_iter().flat_map(|part| part.cells).collect();
            let held = cells.into_iter().filter(|cell| !loose.contains(cell));
            target(held.collect()).ok()
        }
        other => other.ok(),
    }
}

/// Adds the cells of `all` that are connected to those of `open`.
fn spread(open: &mut Vec<Cell>, all: &FxHashSet<Cell>, found: &mut FxHashSet<Cell>) {
    while let Some(at) = open.pop() {
        for next in Face::ALL.into_iter().filter_map(|face| at.across(face)) {
            if all.contains(&next) && found.insert(next) {
                open.push(next);
            }
        }
    }
}
