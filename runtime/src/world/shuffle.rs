//! A world without physics: each tick one magnetized face, drawn at random, captures a block.
//!
//! It has the structure's geometry and no other: good for testing a protocol under many orders of
//! events, useless for times.
use std::collections::{BTreeMap, BTreeSet};

use stochc_ir::{Cell, Face};

use super::lattice::Lattice;
use super::{Body, Docking, Fault, Site, World};
use crate::draw::{Draws, Stream, below, unit};
use crate::orientation::Orientation;

/// A world of cells.
#[derive(Clone, Debug)]
pub struct ShuffleWorld {
    tick: u64,
    draws: Draws,
    /// Blocks that were free at the beginning.
    count: u32,
    lattice: Lattice,
    /// Chance per tick that a block docks on a face that is off.
    strays: f64,
    /// The blocks of the plate whose faces have been on.
    seeds: BTreeSet<Cell>,
    /// The group of each free block, by a number that its members share; `None`: free blocks do not bond.
    groups: Option<Vec<u32>>,
}

impl ShuffleWorld {
    /// A world of `count` free blocks, whose chance is that of (`seed`, `run`).
    pub fn new(count: u32, seed: u64, run: u64) -> ShuffleWorld {
        ShuffleWorld {
            tick: 0,
            draws: Draws::new(seed, run, Stream::Shuffle),
            count,
            lattice: Lattice::default(),
            strays: 0.0,
            seeds: BTreeSet::new(),
            groups: None,
        }
    }

    /// The same, where in about every other tick two free blocks drawn at random bond to each other.
    pub fn with_groups(self) -> ShuffleWorld {
        ShuffleWorld {
            groups: Some((0..self.count).collect()),
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
    pub fn cells(&self) -> &BTreeMap<Cell, u32> {
        self.lattice.cells()
    }

    /// How an anchored block sits.
    pub fn orientation(&self, body: Body) -> Option<Orientation> {
        Some(self.lattice.place(body)?.orientation)
    }
}

impl ShuffleWorld {
    /// The faces that are off and hold nothing, and to which a block can come.
    fn exposed(&self) -> Vec<Site> {
        let seeds = self.seeds.iter().map(|&cell| Body::Seed(cell));
        let blocks = self.lattice.cells().values().map(|&id| Body::Free(id));
        let sites = seeds.chain(blocks).flat_map(|body| {
            let faces = match body {
                Body::Seed(_) => &[Face::Up][..],
                Body::Free(_) => &Face::ALL,
            };
            faces.iter().map(move |&face| Site { body, face })
        });
        sites
            .filter(|site| !self.lattice.active().contains(site))
            .filter(|&site| self.lattice.target(site).is_some())
            .collect()
    }

    /// By chance, two blocks bond, and with them their groups.
    fn gather(&mut self) {
        let Some(groups) = &mut self.groups else {
            return;
        };
        let [whether, one, other, _] = self.draws.step(self.tick).block(2);
        if groups.is_empty() || unit(whether) < 0.5 {
            return;
        }
        let of = |word| groups[below(word, self.count) as usize];
        let (one, other) = (of(one), of(other));
        for group in groups.iter_mut().filter(|group| **group == other) {
            *group = one;
        }
    }

    /// By chance, a block docks where nobody expects it.
    fn stray(&mut self, dockings: &mut Vec<Docking>) {
        if self.strays <= 0.0 {
            return;
        }
        let [whether, which, who, how] = self.draws.step(self.tick).block(1);
        if unit(whether) >= self.strays {
            return;
        }
        let exposed = self.exposed();
        self.dock_one(&exposed, [which, who, how], dockings);
    }

    /// Docks a free block on one of these faces, both and the way it is turned drawn by these words.
    fn dock_one(
        &mut self,
        sites: &[Site],
        [which, who, how]: [u32; 3],
        dockings: &mut Vec<Docking>,
    ) {
        let free: Vec<u32> = (0..self.count)
            .filter(|&id| !self.lattice.is_anchored(id))
            .collect();
        if sites.is_empty() || free.is_empty() {
            return;
        }
        let pose = below(how, 24) as u8;
        let docking = Docking {
            site: sites[below(which, sites.len() as u32) as usize],
            child: free[below(who, free.len() as u32) as usize],
            child_face: Face::ALL[usize::from(pose / 4)],
            turn: pose % 4,
            entries: 1,
            entered: self.tick,
        };
        self.lattice.dock(&docking);
        dockings.push(docking);
    }
}

impl World for ShuffleWorld {
    fn tick(&self) -> u64 {
        self.tick
    }

    fn magnetize(&mut self, site: Site) {
        if let Body::Seed(cell) = site.body {
            self.seeds.insert(cell);
        }
        self.lattice.magnetize(site);
    }

    fn switch_off(&mut self, site: Site) {
        self.lattice.switch_off(site);
    }

    fn plant(&mut self, site: Site) -> Option<Docking> {
        self.magnetize(site);
        self.lattice.target(site)?;
        let child = (0..self.count)
            .rev()
            .find(|&id| !self.lattice.is_anchored(id))?;
        let parent = self.lattice.place(site.body)?.orientation;
        let (child_face, turn) = Orientation::IDENTITY.as_docked(parent, site.face)?;
        let docking = Docking {
            site,
            child,
            child_face,
            turn,
            entries: 1,
            entered: self.tick,
        };
        self.lattice.dock(&docking);
        Some(docking)
    }

    fn largest_group(&self) -> u32 {
        let mut sizes: BTreeMap<u32, u32> = BTreeMap::new();
        for &group in self.groups.iter().flatten() {
            *sizes.entry(group).or_default() += 1;
        }
        sizes.into_values().max().unwrap_or(1)
    }

    fn step(&mut self, dockings: &mut Vec<Docking>) -> Result<(), Fault> {
        self.gather();
        self.stray(dockings);
        let open: Vec<Site> = (self.lattice.active().iter().copied())
            .filter(|&site| self.lattice.target(site).is_some())
            .collect();
        let [which, who, how, _] = self.draws.step(self.tick).block(0);
        self.tick += 1;
        self.dock_one(&open, [which, who, how], dockings);
        Ok(())
    }
}
