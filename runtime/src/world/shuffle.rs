//! A world without physics: each tick one magnetized face, drawn at random, captures a block.
//!
//! It has the structure's geometry and no other: good for testing a protocol under many orders of
//! events, useless for times.
use std::collections::{BTreeMap, BTreeSet};

use stochc_compiler::{Cell, Face};

use super::{Body, Docking, Fault, Site, World};
use crate::draw::{Draws, Stream, below};
use crate::orientation::Orientation;

/// A world of cells.
#[derive(Clone, Debug)]
pub struct ShuffleWorld {
    tick: u64,
    draws: Draws,
    /// The free blocks, by number; `None`: not anchored.
    placed: Vec<Option<Placed>>,
    /// Which block sits in a cell above the plate.
    cells: BTreeMap<Cell, u32>,
    /// The faces that are on and hold nothing, with the tick since when.
    active: BTreeMap<Site, u64>,
    /// The faces that hold a block.
    holds: BTreeMap<Site, u32>,
}

#[derive(Clone, Copy, Debug)]
struct Placed {
    cell: Cell,
    orientation: Orientation,
}

impl ShuffleWorld {
    /// A world of `count` free blocks, whose chance is that of (`seed`, `run`).
    pub fn new(count: u32, seed: u64, run: u64) -> ShuffleWorld {
        ShuffleWorld {
            tick: 0,
            draws: Draws::new(seed, run, Stream::Shuffle),
            placed: vec![None; count as usize],
            cells: BTreeMap::new(),
            active: BTreeMap::new(),
            holds: BTreeMap::new(),
        }
    }

    /// The occupied cells above the plate, each with the number of its block.
    pub fn cells(&self) -> &BTreeMap<Cell, u32> {
        &self.cells
    }

    /// How an anchored block sits.
    pub fn orientation(&self, body: Body) -> Option<Orientation> {
        Some(self.place(body)?.orientation)
    }

    fn place(&self, body: Body) -> Option<Placed> {
        match body {
            Body::Seed(cell) => Some(Placed {
                cell,
                orientation: Orientation::IDENTITY,
            }),
            Body::Free(id) => self.placed[id as usize],
        }
    }

    /// Where a block captured by `site` would sit; `None`: there is no room.
    fn target(&self, site: Site) -> Option<Cell> {
        let parent = self.place(site.body)?;
        let cell = parent
            .cell
            .across(parent.orientation.to_structure(site.face))?;
        (cell.z >= 1 && !self.cells.contains_key(&cell)).then_some(cell)
    }

    fn release(&mut self, id: u32) {
        if let Some(placed) = self.placed[id as usize].take() {
            self.cells.remove(&placed.cell);
        }
        for face in Face::ALL {
            self.switch_off(Site {
                body: Body::Free(id),
                face,
            });
        }
    }
}

impl World for ShuffleWorld {
    fn tick(&self) -> u64 {
        self.tick
    }

    fn magnetize(&mut self, site: Site) {
        if self.place(site.body).is_some() && !self.holds.contains_key(&site) {
            self.active.entry(site).or_insert(self.tick);
        }
    }

    fn switch_off(&mut self, site: Site) {
        self.active.remove(&site);
        if let Some(id) = self.holds.remove(&site) {
            self.release(id);
        }
    }

    fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault> {
        let open: Vec<(Site, Cell)> = self
            .active
            .keys()
            .filter_map(|&site| Some((site, self.target(site)?)))
            .collect();
        let free: BTreeSet<u32> = (0..self.placed.len() as u32)
            .filter(|&id| self.placed[id as usize].is_none())
            .collect();
        let [which, who, how, _] = self.draws.step(self.tick).block(0);
        self.tick += 1;
        if open.is_empty() || free.is_empty() {
            return Ok(());
        }
        let (site, cell) = open[below(which, open.len() as u32) as usize];
        let nth = below(who, free.len() as u32) as usize;
        let child = *free.iter().nth(nth).expect("one of the free blocks");
        let pose = below(how, 24) as u8;
        let (child_face, turn) = (Face::ALL[usize::from(pose / 4)], pose % 4);
        let parent = self.place(site.body).expect("an open site is anchored");
        self.placed[child as usize] = Some(Placed {
            cell,
            orientation: Orientation::docked(parent.orientation, site.face, child_face, turn),
        });
        self.cells.insert(cell, child);
        self.active.remove(&site);
        self.holds.insert(site, child);
        dockings.push(Docking {
            site,
            child,
            child_face,
            turn,
            entries: 1,
            entered: self.tick,
        });
        Ok(())
    }
}
