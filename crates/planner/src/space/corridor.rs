//! Access paths: blocks that must come later so that a cell is reachable in every order.
//!
//! In an order that builds the target, each cell has an access path between the earlier blocks.
//! Later blocks must not close that path in any run. Target blocks on the path therefore wait for
//! the cell. A path may end at the first position on the path of a waiting block. Blocks on the
//! rest of that path wait for this block, and so for the cell.
use std::cmp::Reverse;
use std::collections::BinaryHeap;

use rustc_hash::FxHashMap;
use stochc_estimate::{beside_gap, gap_entrances};
use stochc_grammar::{Cancellation, Cancelled};
use stochc_ir::{Cell, Face};

use crate::disassembly::Disassembly;
use crate::space::free_space::AccessPath;
use crate::space::sites::{NONE, Sites};

/// Sites that wait to keep access paths open.
#[derive(Clone, Debug)]
pub struct Corridors {
    /// For each site, the sites that must wait until it is captured, sorted.
    pub waiting: Vec<Vec<u32>>,
    /// For each site in a gap, the axis of the capturing face. `None` for other sites.
    pub along: Vec<Option<Face>>,
}

/// Costs of an access path. Their order: per step, per waiting block near the cell, per other
/// waiting block, per capture of delay. Nearby blocks cost less, because their faces would not be
/// open at the same time anyway.
const COSTS: [u32; 4] = [1, 2, 6, 4];

impl Corridors {
    /// Returns the cheapest path of each site, the last site first.
    ///
    /// # Errors
    ///
    /// [`Cancelled`] if the search is cancelled.
    pub fn new(
        sites: &Sites<'_>,
        disassembly: &Disassembly,
        cancellation: Cancellation<'_>,
    ) -> Result<Corridors, Cancelled> {
        let mut search = CorridorSearch {
            sites,
            disassembly,
            first: Default::default(),
        };
        let mut waiting = vec![Vec::new(); sites.len()];
        for &site in disassembly.order[sites.existing_count()..].iter().rev() {
            cancellation.check()?;
            waiting[site as usize] = search.cheapest(site);
        }
        let along = disassembly
            .access_path
            .iter()
            .map(|access_path| match access_path {
                Some(AccessPath::Gap(axis)) => Some(*axis),
                _ => None,
            });
        Ok(Corridors {
            waiting,
            along: along.collect(),
        })
    }
}

struct CorridorSearch<'a> {
    sites: &'a Sites<'a>,
    disassembly: &'a Disassembly,
    /// For each position of a cube of size two or one, the site whose access path begins there.
    first: [FxHashMap<Cell, u32>; 2],
}

impl CorridorSearch<'_> {
    /// Returns the sites that wait for a site on its cheapest path.
    fn cheapest(&mut self, site: u32) -> Vec<u32> {
        let access_path = self.disassembly.access_path[site as usize];
        let number = usize::from(access_path.is_none());
        let space = &self.disassembly.spaces[number];
        let rank = self.disassembly.rank[site as usize];
        let earlier = |other: u32| self.disassembly.rank[other as usize] < rank;
        let mut best: FxHashMap<Cell, (u32, Cell)> = FxHashMap::default();
        let mut open = BinaryHeap::new();
        let cell = self.sites.cell(site);
        let lows: Vec<Cell> = match access_path {
            Some(AccessPath::Gap(axis)) => gap_entrances(cell, axis).collect(),
            _ => space.around(cell).collect(),
        };
        for low in lows {
            if space.is_free(self.sites, low, &earlier) {
                let cost = self.toll(site, number, low, None);
                best.insert(low, (cost, low));
                open.push(Reverse((cost, low)));
            }
        }
        while let Some(Reverse((cost, low))) = open.pop() {
            if best[&low].0 < cost {
                continue;
            }
            // The site at this position waits, and so does everything that would close the rest of
            // its path.
            let leads_on = (self.first[number].get(&low))
                .is_some_and(|&other| self.disassembly.rank[other as usize] > rank);
            if space.is_always_open(low) || leads_on {
                return self.follow(site, number, low, &best);
            }
            for next in Face::ALL.into_iter().filter_map(|face| low.across(face)) {
                if !space.is_free(self.sites, next, &earlier) {
                    continue;
                }
                let cost = cost + COSTS[0] + self.toll(site, number, next, Some(low));
                if best.get(&next).is_none_or(|&(known, _)| cost < known) {
                    best.insert(next, (cost, low));
                    open.push(Reverse((cost, next)));
                }
            }
        }
        unreachable!("a removed site has an access path")
    }

    /// Returns the cost of moving the cube from `from` to `low` on the access path of a site. The
    /// cost counts the blocks that must wait for this move.
    fn toll(&self, site: u32, number: usize, low: Cell, from: Option<Cell>) -> u32 {
        let space = &self.disassembly.spaces[number];
        let level = |site: u32| self.disassembly.level[site as usize];
        let is_new = |cell: &Cell| from.is_none_or(|from| space.cells(from).all(|it| it != *cell));
        let sites = space
            .cells(low)
            .filter(is_new)
            .map(|cell| self.sites.at(cell));
        let later = sites.filter(|&other| other != NONE && other != site);
        let toll = later.map(|other| {
            let is_near = self.sites.near(site).any(|near| near == other);
            let late = (level(site) + 1).saturating_sub(level(other));
            (if is_near { COSTS[1] } else { COSTS[2] }) + COSTS[3] * late
        });
        toll.sum()
    }

    /// Returns the sites on the access path of `site` that ends at `low`. Stores the path, so that
    /// earlier sites can use it.
    fn follow(
        &mut self,
        site: u32,
        number: usize,
        mut low: Cell,
        best: &FxHashMap<Cell, (u32, Cell)>,
    ) -> Vec<u32> {
        let space = &self.disassembly.spaces[number];
        let mut waiting = Vec::new();
        loop {
            let inside = space.cells(low).map(|cell| self.sites.at(cell));
            waiting.extend(inside.filter(|&other| other != NONE && other != site));
            let before = best[&low].1;
            if before == low {
                break;
            }
            low = before;
        }
        match self.disassembly.access_path[site as usize] {
            // No block is next to the gap. A block at the position in front need not wait for the
            // block in the gap.
            Some(AccessPath::Gap(axis)) => {
                let beside = beside_gap(self.sites.cell(site), axis);
                waiting.extend(
                    beside
                        .map(|cell| self.sites.at(cell))
                        .filter(|&other| other != NONE),
                );
            }
            // Later sites are processed first. A recorded site comes later than this one and waits
            // for no earlier site.
            _ => {
                self.first[number].insert(low, site);
            }
        }
        waiting.sort_unstable();
        waiting.dedup();
        waiting
    }
}
