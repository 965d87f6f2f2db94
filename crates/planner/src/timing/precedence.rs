//! Dependencies of a schedule, and the ones that a program must state.

use crate::space::sites::Sites;
use crate::target::hardware::Hardware;
use crate::timing::schedule::Schedule;

/// Dependencies by position in the opening order.
#[derive(Clone, Debug)]
pub struct Waiting {
    /// For each position in the opening order, the positions that must be captured first.
    pub before: Vec<Vec<u32>>,
}

/// Reason of a dependency.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Why {
    /// The waiting site is on the access path of the site that it waits for.
    AccessPath,
    /// Nearby faces must not be open at the same time.
    Near,
}

/// Dependency that the program must state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct After {
    pub site: u32,
    pub why: Why,
}

impl Waiting {
    /// Returns, for each site, the dependencies that the program must state.
    ///
    /// Omits dependencies that follow from other dependencies, from attachment, or from the order
    /// of captures by one parent. `on_path` contains the sites on each access path, sorted.
    pub fn afters(
        &self,
        sites: &Sites<'_>,
        hardware: Hardware,
        schedule: &Schedule,
        on_path: &[Vec<u32>],
    ) -> Vec<Vec<After>> {
        let mut afters = vec![Vec::new(); self.before.len()];
        // All dependencies of earlier sites, stated or not.
        let mut edges: Vec<Vec<u32>> = Vec::with_capacity(self.before.len());
        let mut search = Ancestors::new(self.before.len());
        let existing = sites.existing_count();
        edges.resize(existing, Vec::new());
        for (&site, before) in schedule.order.iter().zip(&self.before).skip(existing) {
            let held = schedule.held(sites, site);
            let mut needed: Vec<u32> = held
                .into_iter()
                .chain(schedule.turn(sites, hardware, site))
                .collect();
            // Latest first: their own dependencies are implied.
            for &other in before.iter().rev() {
                if needed.contains(&other) || search.reach(&edges, &needed, other) {
                    continue;
                }
                needed.push(other);
                let other = schedule.order[other as usize];
                let is_on_path = on_path
                    .get(other as usize)
                    .is_some_and(|path| path.binary_search(&site).is_ok());
                let why = if is_on_path {
                    Why::AccessPath
                } else {
                    Why::Near
                };
                afters[site as usize].push(After { site: other, why });
            }
            edges.push(needed);
        }
        afters
    }
}

/// Search for the transitive predecessors of a position.
struct Ancestors {
    /// For each position, the number of the last search that visited it.
    seen: Vec<u32>,
    search: u32,
    open: Vec<u32>,
}

impl Ancestors {
    fn new(places: usize) -> Ancestors {
        Ancestors {
            seen: vec![0; places],
            search: 0,
            open: Vec::new(),
        }
    }

    /// Returns whether one of `from` depends on `to`, directly or transitively. May return `false`
    /// for long chains.
    fn reach(&mut self, edges: &[Vec<u32>], from: &[u32], to: u32) -> bool {
        const MAX: usize = 300;
        self.search += 1;
        self.open.clear();
        self.open.extend(from);
        let mut seen = 0;
        while let Some(at) = self.open.pop() {
            for &before in &edges[at as usize] {
                if before == to {
                    return true;
                }
                if before > to && self.seen[before as usize] != self.search {
                    self.seen[before as usize] = self.search;
                    seen += 1;
                    self.open.push(before);
                }
            }
            if seen > MAX {
                return false;
            }
        }
        false
    }
}
