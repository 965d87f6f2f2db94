//! Opening order of cells, with their parents.
use stochc_ir::Face;

use crate::space::sites::{NONE, Sites};
use crate::target::hardware::Hardware;

/// Opening order of the sites, with the parent of each site.
#[derive(Clone, Debug)]
pub struct Schedule {
    /// Sites in opening order.
    pub order: Vec<u32>,
    /// Position of each site in the opening order.
    pub rank: Vec<u32>,
    /// Direction to each site from its parent, which is a site or a seed.
    pub direction: Vec<Face>,
    /// Mean waiting time of each site \[ticks\].
    pub mean: Vec<f32>,
    /// Capture time of each site for mean waiting times \[ticks\].
    pub end: Vec<f32>,
    /// Number of sites opened before the hand-over phase. All sites without scaffolds.
    pub first_phase: usize,
    /// For each site that is handed over, the site that must be occupied before. Empty without
    /// scaffolds.
    pub roots: Vec<u32>,
}

impl Schedule {
    pub fn empty(sites: usize) -> Schedule {
        Schedule {
            order: Vec::with_capacity(sites),
            rank: vec![NONE; sites],
            direction: vec![Face::Up; sites],
            mean: vec![0.0; sites],
            end: vec![0.0; sites],
            first_phase: sites,
            roots: Vec::new(),
        }
    }

    /// Adds a site that opens last at time `start` and waits for `mean` \[ticks\].
    pub(crate) fn add(&mut self, site: u32, direction: Face, start: f32, mean: f32) {
        let here = site as usize;
        self.rank[here] = self.order.len() as u32;
        self.order.push(site);
        self.direction[here] = direction;
        self.mean[here] = mean;
        self.end[here] = start + mean;
    }

    /// Returns the parent of a site, or [`NONE`] for a seed.
    pub fn parent(&self, sites: &Sites<'_>, site: u32) -> u32 {
        sites.next(site, self.direction[site as usize].opposite())
    }

    /// Returns the direction and capture time of a site that opens before a position \[ticks\].
    /// Returns `None` for a site that opens later.
    pub fn before(&self, site: u32, place: u32) -> Option<(Face, f32)> {
        let here = site as usize;
        (self.rank[here] < place).then(|| (self.direction[here], self.end[here]))
    }

    /// Returns the children of a site, once all directions are set.
    pub fn children(&self, sites: &Sites<'_>, parent: u32) -> impl Iterator<Item = u32> {
        let adjacent = sites.adjacent(parent);
        adjacent.filter(move |&other| self.parent(sites, other) == parent)
    }

    /// Returns the position of a block in the opening order. This block holds `site` and is
    /// captured in the same phase. Returns `None` if the holding block exists before the phase.
    pub fn held(&self, sites: &Sites<'_>, site: u32) -> Option<u32> {
        let parent = self.parent(sites, site);
        let same = |other: u32| (other != NONE && self.is_same_phase(site, other)).then_some(other);
        let root = self.roots.get(parent as usize);
        let holder = same(parent).or_else(|| same(*root?));
        holder.map(|holder| self.rank[holder as usize])
    }

    pub fn is_same_phase(&self, site: u32, other: u32) -> bool {
        let is_first = |site: u32| (self.rank[site as usize] as usize) < self.first_phase;
        is_first(site) == is_first(other)
    }

    /// Returns the position of the previous capture by the same parent. Returns `None` if there is
    /// none, or if captures by one parent need not take turns.
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
