//! What waits for what in a schedule, and which of that has to be said.
use stochc_ir::Face;

use crate::Hardware;
use crate::schedule::{Schedule, SchedulingJob};
use crate::sites::{NONE, Sites};

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

impl Schedule {
    /// The site that holds another one; [`NONE`]: a seed does.
    pub fn parent(&self, sites: &Sites<'_>, site: u32) -> u32 {
        sites.next(site, self.way[site as usize].opposite())
    }

    /// The way to a site that opens before a place in the order, and when its block comes \[ticks\].
    pub fn before(&self, site: u32, place: u32) -> Option<(Face, f32)> {
        let here = site as usize;
        (self.rank[here] < place).then(|| (self.way[here], self.end[here]))
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
        let siblings = sites
            .adjacent(parent)
            .filter(|&other| self.parent(sites, other) == parent)
            .filter(|&other| self.is_same_phase(site, other));
        let ranks = siblings.map(|other| self.rank[other as usize]);
        ranks.filter(|&rank| rank < self.rank[site as usize]).max()
    }
}

impl Waiting {
    /// Everything that a schedule has in some order.
    pub fn of(job: &SchedulingJob<'_>, schedule: &Schedule) -> Waiting {
        let mut before: Vec<Vec<u32>> = vec![Vec::new(); schedule.order.len()];
        let existing = job.sites.existing_count();
        for (i, &site) in schedule.order.iter().enumerate().skip(existing) {
            let rank = |site: u32| schedule.rank[site as usize];
            before[i].extend(schedule.held(job.sites, site));
            before[i].extend(schedule.turn(job.sites, job.hardware, site));
            let crowding = job.crowding();
            let way = schedule.way[site as usize];
            let crowd = crowding.waits(site, way, |near| schedule.before(near, i as u32));
            before[i].extend(crowd.into_iter().map(rank));
            for &waiting in &job.corridors.waiting[site as usize] {
                before[rank(waiting) as usize].push(i as u32);
            }
        }
        let first = schedule.first_phase as u32;
        for (before, i) in before.iter_mut().zip(0..) {
            // A phase waits for all of the one before.
            before.retain(|&other| (other < first) == (i < first) && other >= existing as u32);
            before.sort_unstable();
            before.dedup();
        }
        Waiting { before }
    }

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
        const MOST: usize = 300;
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
            if seen > MOST {
                return false;
            }
        }
        false
    }
}
