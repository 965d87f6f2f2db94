//! An order in which cells open, with their parents.
use stochc_ir::Face;

use crate::hardware::Hardware;
use crate::sites::{NONE, Sites};

/// An order with its parents.
#[derive(Clone, Debug)]
pub struct Schedule {
    /// The sites in the order in which they open.
    pub order: Vec<u32>,
    /// The place of each site in that order.
    pub rank: Vec<u32>,
    /// For each site the way from its parent, which is the site or the seed on the other side.
    pub way: Vec<Face>,
    /// The mean wait of each site \[ticks\].
    pub mean: Vec<f32>,
    /// When the block of each site comes, if all waits are as long as their means \[ticks\].
    pub end: Vec<f32>,
    /// How many sites open before the phase in which blocks are handed over; that many as there are without scaffolds.
    pub first_phase: usize,
    /// Of each site that is handed over, the one that has to be there before; empty without scaffolds.
    pub roots: Vec<u32>,
}

impl Schedule {
    /// Nothing of so many sites.
    pub fn empty(sites: usize) -> Schedule {
        Schedule {
            order: Vec::with_capacity(sites),
            rank: vec![NONE; sites],
            way: vec![Face::Up; sites],
            mean: vec![0.0; sites],
            end: vec![0.0; sites],
            first_phase: sites,
            roots: Vec::new(),
        }
    }

    /// Adds a site that opens after all others, at a time, and waits for so long \[ticks\].
    pub(crate) fn add(&mut self, site: u32, way: Face, start: f32, mean: f32) {
        let here = site as usize;
        self.rank[here] = self.order.len() as u32;
        self.order.push(site);
        self.way[here] = way;
        self.mean[here] = mean;
        self.end[here] = start + mean;
    }

    /// The site that holds another one; [`NONE`]: a seed does.
    pub fn parent(&self, sites: &Sites<'_>, site: u32) -> u32 {
        sites.next(site, self.way[site as usize].opposite())
    }

    /// The way to a site that opens before a place in the order, and when its block comes \[ticks\].
    pub fn before(&self, site: u32, place: u32) -> Option<(Face, f32)> {
        let here = site as usize;
        (self.rank[here] < place).then(|| (self.way[here], self.end[here]))
    }

    /// The sites that one holds, once all have a way.
    pub fn children(&self, sites: &Sites<'_>, parent: u32) -> impl Iterator<Item = u32> {
        let adjacent = sites.adjacent(parent);
        adjacent.filter(move |&other| self.parent(sites, other) == parent)
    }

    /// Says of each site its place in the order, after that has changed.
    pub(crate) fn set_ranks(&mut self) {
        for (rank, &site) in (0..).zip(&self.order) {
            self.rank[site as usize] = rank;
        }
    }

    /// The place in the order of what has to be there in the same phase to hold a site; `None`: it is there before.
    pub fn held(&self, sites: &Sites<'_>, site: u32) -> Option<u32> {
        let parent = self.parent(sites, site);
        let same = |other: u32| (other != NONE && self.is_same_phase(site, other)).then_some(other);
        let root = self.roots.get(parent as usize);
        let holder = same(parent).or_else(|| same(*root?));
        holder.map(|holder| self.rank[holder as usize])
    }

    /// Whether two sites open in the same phase.
    pub fn is_same_phase(&self, site: u32, other: u32) -> bool {
        let is_first = |site: u32| (self.rank[site as usize] as usize) < self.first_phase;
        is_first(site) == is_first(other)
    }

    /// The place in the order of the capture of the same parent that comes just before a site's, where only one face may be open.
    pub fn turn(&self, sites: &Sites<'_>, hardware: Hardware, site: u32) -> Option<u32> {
        if hardware.faces != 1 || hardware.attracts_always {
            return None;
        }
        let parent = Some(self.parent(sites, site)).filter(|&parent| parent != NONE)?;
        let siblings = self.children(sites, parent);
        let siblings = siblings.filter(|&other| self.is_same_phase(site, other));
        let ranks = siblings.map(|other| self.rank[other as usize]);
        ranks.filter(|&rank| rank < self.rank[site as usize]).max()
    }
}
