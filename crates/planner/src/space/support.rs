//! Connection of the standing blocks to the plate.
use std::collections::VecDeque;

use crate::space::sites::{MIDDLE, NONE, Sites, across, place};
use stochc_ir::Face;

/// Standing blocks, with a level for each site. A site on a seed has level 1. Every other site has
/// a higher level than one of its neighbours.
///
/// Levels start from a breadth-first search and are raised when blocks are removed.
///
/// # Source
///
/// S. Even and Y. Shiloach, An on-line edge-deletion problem (1981).
#[derive(Clone, Debug)]
pub struct Support {
    level: Vec<u32>,
    stands: Vec<bool>,
}

impl Support {
    /// Returns the state of a complete target.
    pub fn new(sites: &Sites<'_>) -> Support {
        let mut level = vec![NONE; sites.len()];
        let mut queue: VecDeque<u32> = (0..sites.len() as u32)
            .filter(|&site| sites.is_root(site) && !sites.is_inert(site))
            .collect();
        for &site in &queue {
            level[site as usize] = 1;
        }
        while let Some(site) = queue.pop_front() {
            for next in sites.adjacent(site) {
                if level[next as usize] == NONE && !sites.is_inert(next) {
                    level[next as usize] = level[site as usize] + 1;
                    queue.push_back(next);
                }
            }
        }
        let stands = vec![true; sites.len()];
        Support { level, stands }
    }

    /// Returns the level of a standing site: an upper bound on its number of steps from the plate.
    pub fn level(&self, site: u32) -> u32 {
        self.level[site as usize]
    }

    pub fn stands(&self, site: u32) -> bool {
        self.stands[site as usize]
    }

    /// Returns whether all other blocks certainly stay connected to the plate if a site is removed.
    /// A result of `false` is not certain.
    pub fn can_spare(&self, sites: &Sites<'_>, site: u32) -> bool {
        let is_held = |next: u32| {
            let level = self.level(next);
            level <= self.level(site)
                || self
                    .present_neighbours(sites, next)
                    .any(|other| other != site && self.level(other) < level)
        };
        self.present_neighbours(sites, site).all(is_held) || self.is_locally_connected(sites, site)
    }

    fn present_neighbours(&self, sites: &Sites<'_>, site: u32) -> impl Iterator<Item = u32> {
        // Blocks that hold nothing need no support as parents.
        let able = sites.adjacent(site).filter(|&next| !sites.is_inert(next));
        able.filter(|&next| self.stands(next))
    }

    /// Returns whether the neighbours of a site are connected within its window. If the site
    /// touches the plate, the neighbours must also be connected to the plate.
    fn is_locally_connected(&self, sites: &Sites<'_>, site: u32) -> bool {
        const ROOT: u32 = 1 << 27;
        let stands = |near| self.stands(near) && !sites.is_inert(near);
        let full = sites.window(site, stands) & !(1 << MIDDLE);
        let grounded = sites.window(site, |near| sites.is_root(near));
        let mut required = FACES & full;
        if grounded & 1 << MIDDLE != 0 {
            required |= ROOT;
        }
        let grounded = grounded & full;
        let mut found = required & required.wrapping_neg();
        loop {
            let mut next = found;
            for (i, beside) in BESIDE.iter().enumerate() {
                if found & 1 << i != 0 {
                    next |= beside & full;
                }
            }
            if found & ROOT != 0 {
                next |= grounded;
            }
            if found & grounded != 0 {
                next |= ROOT;
            }
            if next == found {
                return required & !found == 0;
            }
            found = next;
        }
    }

    /// Removes a site that no other site needs for its connection to the plate.
    pub fn remove(&mut self, sites: &Sites<'_>, site: u32) {
        self.stands[site as usize] = false;
        let mut queue: Vec<u32> = self.present_neighbours(sites, site).collect();
        while let Some(site) = queue.pop() {
            if sites.is_root(site) {
                continue;
            }
            let lowest = self
                .present_neighbours(sites, site)
                .map(|next| self.level(next))
                .min();
            let Some(lowest) = lowest.filter(|&lowest| lowest >= self.level(site)) else {
                continue;
            };
            self.level[site as usize] = lowest + 1;
            queue.push(site);
            queue.extend(self.present_neighbours(sites, site));
        }
    }

    /// Returns the standing sites whose removal would disconnect other sites from the plate: the
    /// articulation points.
    pub fn articulation_points(&self, sites: &Sites<'_>) -> Vec<bool> {
        let count = sites.len();
        let mut is_cut = vec![false; count];
        let mut entered = vec![0u32; count];
        let mut lowest = vec![0u32; count];
        // The search enters the plate first.
        let mut clock = 1;
        for root in 0..count as u32 {
            let is_root = sites.is_root(root) && !sites.is_inert(root);
            if !self.stands(root) || !is_root || entered[root as usize] > 0 {
                continue;
            }
            // A site, its predecessor, and the number of faces examined.
            let mut stack = vec![(root, NONE, 0usize)];
            while let Some((site, from, looked)) = stack.last_mut() {
                let (site, from) = (*site, *from);
                let here = site as usize;
                if *looked == 0 {
                    clock += 1;
                    entered[here] = clock;
                    lowest[here] = if sites.is_root(site) { 1 } else { clock };
                }
                let Some(&face) = Face::ALL.get(*looked) else {
                    stack.pop();
                    if from != NONE {
                        let before = from as usize;
                        is_cut[before] |= lowest[here] >= entered[before];
                        lowest[before] = lowest[before].min(lowest[here]);
                    }
                    continue;
                };
                *looked += 1;
                let next = sites.next(site, face);
                if next == NONE || !self.stands(next) || next == from || sites.is_inert(next) {
                    continue;
                }
                match entered[next as usize] {
                    0 => stack.push((next, site, 0)),
                    earlier => lowest[here] = lowest[here].min(earlier),
                }
            }
        }
        is_cut
    }
}

/// Set of the six cells of a window that share a face with the centre.
const FACES: u32 = {
    let mut bits = 0;
    let mut i = 0;
    while i < 6 {
        bits |= 1 << across(Face::ALL[i]);
        i += 1;
    }
    bits
};

/// For each cell of a window, the set of cells that share a face with it.
const BESIDE: [u32; 27] = {
    let mut beside = [0; 27];
    let mut i = 0;
    while i < 27 {
        let (x, y, z) = (i as i32 % 3 - 1, i as i32 / 3 % 3 - 1, i as i32 / 9 - 1);
        let mut j = 0;
        while j < 6 {
            let [dx, dy, dz] = Face::ALL[j].normal();
            let (x, y, z) = (x + dx, y + dy, z + dz);
            if x >= -1 && x <= 1 && y >= -1 && y <= 1 && z >= -1 && z <= 1 {
                beside[i] |= 1 << place(x, y, z);
            }
            j += 1;
        }
        i += 1;
    }
    beside
};

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use stochc_ir::Cell;
    use stochc_ir::table::Plate;

    use super::*;
    use crate::target::structure::held;

    /// Returns whether all standing sites would be connected to the plate if the site `without`
    /// were removed.
    fn hangs_together(sites: &Sites<'_>, support: &Support, without: u32) -> bool {
        let stands = |site: u32| site != without && support.stands(site);
        let all = || (0..sites.len() as u32).filter(|&site| stands(site));
        let mut open: Vec<u32> = all().filter(|&site| sites.is_on_seed(site)).collect();
        let mut found = vec![false; sites.len()];
        while let Some(site) = open.pop() {
            if !std::mem::replace(&mut found[site as usize], true) {
                open.extend(sites.adjacent(site).filter(|&next| stands(next)));
            }
        }
        all().all(|site| found[site as usize])
    }

    proptest! {
        #[test]
        fn removable_blocks_support_nothing(cells in proptest::collection::vec((0..4, 0..4, 1..4), 1..50), order in any::<u64>()) {
            let cells: Vec<Cell> = cells.into_iter().map(|(x, y, z)| Cell::new(x, y, z)).collect();
            let plate = Plate { width: 3, depth: 3 };
            let Some(target) = held(cells, &plate) else {
                return Ok(());
            };
            let sites = Sites::new(&target);
            let mut support = Support::new(&sites);
            let mut order = order;
            loop {
                let is_cut = support.articulation_points(&sites);
                let standing = (0..sites.len() as u32).filter(|&site| support.stands(site));
                let standing: Vec<u32> = standing.collect();
                let mut free = Vec::new();
                for &site in &standing {
                    let is_free = hangs_together(&sites, &support, site);
                    prop_assert_eq!(!is_cut[site as usize], is_free);
                    prop_assert!(is_free || !support.can_spare(&sites, site));
                    let level = support.level(site);
                    let below = support.present_neighbours(&sites, site).any(|next| support.level(next) < level);
                    prop_assert!(below || (level == 1 && sites.is_on_seed(site)));
                    free.extend(is_free.then_some(site));
                }
                if standing.is_empty() {
                    break;
                }
                // Some site can always be removed.
                prop_assert!(!free.is_empty());
                support.remove(&sites, free[order as usize % free.len()]);
                order = order.rotate_left(7) ^ 0x9e37;
            }
        }
    }
}
