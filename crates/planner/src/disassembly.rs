//! Construction order by disassembly of the target.
//!
//! A block may be removed if a free one could reach its place, and the rest stays attached to the
//! plate. Removal only opens paths, so a removable block stays removable. The last block removed is
//! built first. Blocks with an access path two cells wide, or at the end of a passable gap, are
//! removed first. Blocks far from the plate are removed before near ones.
use std::collections::BinaryHeap;

use stochc_grammar::Cancellation;

use crate::TargetError;
use crate::space::free_space::{AccessPath, FreeSpace};
use crate::space::grid::shifted;
use crate::space::sites::{NONE, Sites};
use crate::space::support::Support;

/// Construction order with its access paths.
#[derive(Clone, Debug)]
pub struct Disassembly {
    /// Sites in construction order.
    pub order: Vec<u32>,
    /// Position of each site in the construction order.
    pub rank: Vec<u32>,
    /// Access to each site from a path two cells wide. `None` if there is no such path.
    pub access_path: Vec<Option<AccessPath>>,
    /// Number of steps from the plate to each site within the complete target.
    pub level: Vec<u32>,
    /// Free space for a cube with edges of two cells, and for a cube of one cell.
    pub spaces: [FreeSpace; 2],
}

impl Disassembly {
    /// Returns the number of sites without an access path two cells wide.
    pub fn narrow_count(&self) -> usize {
        self.access_path
            .iter()
            .filter(|path| path.is_none())
            .count()
    }
}

/// Removable sites, the most urgent first.
type Frontier = BinaryHeap<(u32, u32)>;

/// Disassembles a target. Among sites at about the same distance from the plate, the site with the
/// highest key is removed first.
///
/// # Errors
///
/// [`TargetError::Sealed`] if no remaining block can be removed, and [`TargetError::Cancelled`].
pub fn disassemble(
    sites: &Sites<'_>,
    spaces: [FreeSpace; 2],
    keys: &[f32],
    cancellation: Cancellation<'_>,
) -> Result<Disassembly, TargetError> {
    let support = Support::new(sites);
    let level: Vec<u32> = (0..sites.len() as u32)
        .map(|site| support.level(site))
        .collect();
    let urgency = |site: u32| {
        let key = level[site as usize] as f32 + 2.0 * keys[site as usize];
        // Positive numbers sort like their bits.
        (key.to_bits(), site)
    };
    let mut disassembler = Disassembler {
        sites,
        support,
        spaces,
        taken: Vec::with_capacity(sites.len()),
        access_path: vec![Some(AccessPath::Inside); sites.len()],
        frontiers: std::array::from_fn(|_| (0..sites.len() as u32).map(urgency).collect()),
        is_queued: std::array::from_fn(|_| vec![true; sites.len()]),
        undecided: [Vec::new(), Vec::new()],
        urgency: &urgency,
    };
    while disassembler.taken.len() < sites.len() - sites.existing_count() {
        cancellation.check()?;
        let wide = disassembler
            .next(0)
            .or_else(|| disassembler.next_exactly(0));
        let found = match wide {
            Some((site, access_path)) => Some((site, Some(access_path))),
            None => {
                let narrow = disassembler
                    .next(1)
                    .or_else(|| disassembler.next_exactly(1));
                narrow.map(|(site, _)| (site, None))
            }
        };
        let Some((site, access_path)) = found else {
            let stands =
                |site: &u32| disassembler.support.stands(*site) && !sites.is_existing(*site);
            let left = (0..sites.len() as u32).filter(stands);
            return Err(TargetError::Sealed(
                left.map(|site| sites.cell(site)).collect(),
            ));
        };
        disassembler.take(site, access_path);
    }
    let Disassembler {
        taken: mut order,
        access_path,
        spaces,
        ..
    } = disassembler;
    // Existing blocks come first.
    order.extend(sites.existing().map(|(site, _)| site));
    order.reverse();
    let mut rank = vec![0; order.len()];
    for (i, &site) in order.iter().enumerate() {
        rank[site as usize] = i as u32;
    }
    Ok(Disassembly {
        order,
        rank,
        access_path,
        level,
        spaces,
    })
}

struct Disassembler<'a, U> {
    sites: &'a Sites<'a>,
    support: Support,
    spaces: [FreeSpace; 2],
    taken: Vec<u32>,
    access_path: Vec<Option<AccessPath>>,
    /// Queued sites for each of [`Self::spaces`]. Each may have an access path.
    frontiers: [Frontier; 2],
    /// For each of the spaces and each site, whether the site is queued.
    is_queued: [Vec<bool>; 2],
    /// For each of the spaces, skipped sites that have an access path. Removing such a site may
    /// disconnect others.
    undecided: [Vec<u32>; 2],
    urgency: &'a U,
}

impl<U: Fn(u32) -> (u32, u32)> Disassembler<'_, U> {
    /// Returns a queued site that has an access path in a space, and that no other site needs for
    /// support. Skips sites that may be needed. Returns `None` if no queued site can be removed.
    fn next(&mut self, space: usize) -> Option<(u32, AccessPath)> {
        while let Some((_, site)) = self.frontiers[space].pop() {
            self.is_queued[space][site as usize] = false;
            let stands = |site: u32| self.support.stands(site);
            if self.sites.is_existing(site) || !stands(site) {
                continue;
            }
            let Some(access_path) = self.spaces[space].access_path(self.sites, site, &stands)
            else {
                continue;
            };
            if self.support.can_spare(self.sites, site) {
                return Some((site, access_path));
            }
            self.undecided[space].push(site);
        }
        None
    }

    /// Returns the most urgent skipped site that can be removed. Searches the whole structure for
    /// sites that others need. Returns `None` if no skipped site can be removed.
    fn next_exactly(&mut self, space: usize) -> Option<(u32, AccessPath)> {
        let support = &self.support;
        self.undecided[space].retain(|&site| support.stands(site));
        self.undecided[space].sort_unstable();
        self.undecided[space].dedup();
        if self.undecided[space].is_empty() {
            return None;
        }
        let is_cut = support.articulation_points(self.sites);
        let free = self.undecided[space]
            .iter()
            .copied()
            .filter(|&site| !is_cut[site as usize]);
        let site = free.max_by_key(|&site| (self.urgency)(site))?;
        let stands = |site: u32| self.support.stands(site);
        Some((
            site,
            self.spaces[space].access_path(self.sites, site, &stands)?,
        ))
    }

    fn take(&mut self, site: u32, access_path: Option<AccessPath>) {
        self.support.remove(self.sites, site);
        self.taken.push(site);
        self.access_path[site as usize] = access_path;
        let (sites, support) = (self.sites, &self.support);
        let stands = |site: u32| support.stands(site);
        for (number, space) in self.spaces.iter_mut().enumerate() {
            let (frontier, is_queued) = (&mut self.frontiers[number], &mut self.is_queued[number]);
            let mut queue = |site: u32| {
                if stands(site) && !std::mem::replace(&mut is_queued[site as usize], true) {
                    frontier.push((self.urgency)(site));
                }
            };
            around(sites, site).for_each(&mut queue);
            let mut new = Vec::new();
            space.open(sites, site, &stands, &mut |low| new.push(low));
            for low in new {
                space.concerned(sites, low).for_each(&mut queue);
            }
        }
    }
}

/// Returns the sites at most two steps away in every direction.
fn around<'a>(sites: &'a Sites<'_>, site: u32) -> impl Iterator<Item = u32> + 'a {
    let cell = sites.cell(site);
    let cells = (0..125).map(move |i| shifted(cell, i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2));
    cells
        .map(|cell| sites.at(cell))
        .filter(|&near| near != NONE)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;
    use stochc_ir::table::Plate;
    use stochc_ir::{Cell, Face};

    use super::*;
    use crate::target::structure::held;

    /// Returns the cells of a cube with edges of `size` cells.
    fn cube(low: Cell, size: i32) -> impl Iterator<Item = Cell> {
        let steps = move || 0..size;
        steps().flat_map(move |dz| {
            steps().flat_map(move |dy| steps().map(move |dx| shifted(low, dx, dy, dz)))
        })
    }

    /// Returns whether a cube with edges of `size` cells can come from outside and cover a cell.
    /// Tries every position.
    fn has_path(full: &BTreeSet<Cell>, cell: Cell, size: i32) -> bool {
        comes_out(
            full,
            cube(shifted(cell, 1 - size, 1 - size, 1 - size), size),
            size,
        )
    }

    /// Returns whether a cube of size two can reach a gap along an axis. The cube must cover a cell
    /// next to the gap, but not the gap itself. All cells next to the gap above the ground must be
    /// empty.
    fn has_path_to_gap(full: &BTreeSet<Cell>, cell: Cell, axis: Face) -> bool {
        let aside = || {
            let faces = Face::ALL.into_iter();
            let faces = faces.filter(|face| *face != axis && *face != axis.opposite());
            faces.map(|face| cell.across(face).unwrap())
        };
        let lows = cube(shifted(cell, -2, -2, -2), 4).filter(|&low| {
            let holds = |cell: Cell| cube(low, 2).any(|it| it == cell);
            !holds(cell) && aside().any(holds)
        });
        aside().all(|beside| beside.z < 1 || !full.contains(&beside)) && comes_out(full, lows, 2)
    }

    /// Returns whether a cube with edges of `size` cells can move from one of these positions to
    /// the outside.
    fn comes_out(full: &BTreeSet<Cell>, lows: impl Iterator<Item = Cell>, size: i32) -> bool {
        let inside = |low: Cell| [low.x, low.y, low.z].iter().all(|at| (-4..=9).contains(at));
        let is_free = |low: Cell| low.z >= 1 && cube(low, size).all(|cell| !full.contains(&cell));
        let mut open: Vec<Cell> = lows.filter(|&low| is_free(low)).collect();
        let mut found: BTreeSet<Cell> = open.iter().copied().collect();
        while let Some(low) = open.pop() {
            if !inside(low) {
                return true;
            }
            for next in Face::ALL.into_iter().filter_map(|face| low.across(face)) {
                if is_free(next) && found.insert(next) {
                    open.push(next);
                }
            }
        }
        false
    }

    proptest! {
        #[test]
        fn orders_use_existing_access_paths(
            cells in proptest::collection::vec((0..5, 0..5, 1..5), 1..70),
            has_gaps: bool,
        ) {
            let cells: Vec<Cell> = cells.into_iter().map(|(x, y, z)| Cell::new(x, y, z)).collect();
            let plate = Plate { width: 4, depth: 4 };
            let Some(target) = held(cells, &plate) else {
                return Ok(());
            };
            let sites = Sites::new(&target);
            let spaces = || [FreeSpace::new(&sites, 2).with_gaps(has_gaps), FreeSpace::new(&sites, 1)];
            let keys = vec![0.5; sites.len()];
            let disassembly = disassemble(&sites, spaces(), &keys, Cancellation::NEVER);
            // Every connected structure can be built.
            let disassembly = disassembly.unwrap();
            let mut full: BTreeSet<Cell> = BTreeSet::new();
            for &site in &disassembly.order {
                let cell = sites.cell(site);
                let is_held = sites.is_on_seed(site)
                    || Face::ALL.iter().any(|&face| full.contains(&cell.across(face).unwrap()));
                prop_assert!(is_held);
                let access_path = disassembly.access_path[site as usize];
                let is_there = match access_path {
                    Some(AccessPath::Inside) => has_path(&full, cell, 2),
                    Some(AccessPath::Gap(axis)) => {
                        let ends = [axis, axis.opposite()].map(|face| cell.across(face).unwrap());
                        let is_plate = axis == Face::Up && sites.is_on_seed(site);
                        has_gaps
                            && has_path_to_gap(&full, cell, axis)
                            && (is_plate || ends.iter().any(|end| full.contains(end)))
                    }
                    None => has_path(&full, cell, 1),
                };
                prop_assert!(is_there, "{} by {:?}", cell, access_path);
                full.insert(cell);
            }
            prop_assert_eq!(full.len(), sites.len());
        }
    }
}
