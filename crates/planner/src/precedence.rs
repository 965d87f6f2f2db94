//! What waits for what in a schedule, and which of that has to be said.

use crate::hardware::Hardware;
use crate::schedule::Schedule;
use crate::sites::Sites;

/// What each site waits for, by the place of sites in the order in which they open.
#[derive(Clone, Debug)]
pub struct Waiting {
    /// Of the sites in their order: the places of those that each waits for, all before it.
    pub before: Vec<Vec<u32>>,
}

/// Why a site waits for another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Why {
    /// It lies in the way in of the other.
    Way,
    /// Faces near each other are not open at the same time.
    Near,
}

/// A wait that the program has to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct After {
    /// The site that is waited for.
    pub site: u32,
    /// Why.
    pub why: Why,
}

impl Waiting {
    /// Of each site, by its number, the waits that do not follow from others, from being held and from taking turns; `in_way`: of each site,
    /// those that lie in its way in, sorted.
    pub fn afters(
        &self,
        sites: &Sites<'_>,
        hardware: Hardware,
        schedule: &Schedule,
        in_way: &[Vec<u32>],
    ) -> Vec<Vec<After>> {
        let mut afters = vec![Vec::new(); self.before.len()];
        // What is said, and what need not be, of the sites before.
        let mut edges: Vec<Vec<u32>> = Vec::with_capacity(self.before.len());
        let mut search = Ancestors::new(self.before.len());
        let existing = sites.existing_count();
        edges.resize(existing, Vec::new());
        for (&site, before) in schedule.order.iter().zip(&self.before).skip(existing) {
            let held = schedule.held(sites, site);
            let mut kept: Vec<u32> = held
                .into_iter()
                .chain(schedule.turn(sites, hardware, site))
                .collect();
            // The latest first: what they wait for themselves goes without saying.
            for &other in before.iter().rev() {
                if kept.contains(&other) || search.reach(&edges, &kept, other) {
                    continue;
                }
                kept.push(other);
                let other = schedule.order[other as usize];
                let is_way = in_way
                    .get(other as usize)
                    .is_some_and(|way| way.binary_search(&site).is_ok());
                let why = if is_way { Why::Way } else { Why::Near };
                afters[site as usize].push(After { site: other, why });
            }
            edges.push(kept);
        }
        afters
    }
}

/// Looks for what others wait for.
struct Ancestors {
    /// Of each place, the number of the last search that came to it.
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

    /// Whether one of `from` waits for `to`, directly or not; a long way may be missed.
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
