//! What waits for what in a schedule, and which of that has to be said.
use crate::Hardware;
use crate::schedule::{Job, Schedule};
use crate::sites::NONE;

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

/// The capture of the same parent that comes just before a site's, where only one face may be open.
fn turn(job: &Job<'_>, schedule: &Schedule, site: u32) -> Option<u32> {
    let Hardware {
        faces,
        attracts_always,
        ..
    } = job.hardware;
    if faces != 1 || attracts_always {
        return None;
    }
    let parent = match job.parent(site, schedule.way[site as usize]) {
        NONE => return None,
        parent => parent,
    };
    let siblings = job.sites.adjacent(parent).filter(|&other| {
        other != site && job.parent(other, schedule.way[other as usize]) == parent
    });
    let rank = |site: u32| schedule.rank[site as usize];
    let earlier = siblings.filter(|&other| rank(other) < rank(site));
    earlier.max_by_key(|&other| rank(other))
}

impl Waiting {
    /// Everything that a schedule has in some order.
    pub fn of(job: &Job<'_>, schedule: &Schedule) -> Waiting {
        let mut before: Vec<Vec<u32>> = vec![Vec::new(); schedule.order.len()];
        for (i, &site) in schedule.order.iter().enumerate() {
            let rank = |site: u32| schedule.rank[site as usize];
            let parent = job.parent(site, schedule.way[site as usize]);
            before[i].extend((parent != NONE).then(|| rank(parent)));
            before[i].extend(turn(job, schedule, site).map(rank));
            if !job.hardware.attracts_always {
                let near = job.sites.near(site).map(rank);
                before[i].extend(near.filter(|&near| near < i as u32));
            }
            for &waiting in &job.corridors.waiting[site as usize] {
                before[rank(waiting) as usize].push(i as u32);
            }
        }
        for before in &mut before {
            before.sort_unstable();
            before.dedup();
        }
        Waiting { before }
    }

    /// Of each site, by its number, the waits that do not follow from others, from being held and from taking turns.
    pub fn afters(&self, job: &Job<'_>, schedule: &Schedule) -> Vec<Vec<After>> {
        let mut afters = vec![Vec::new(); self.before.len()];
        // What is said, and what need not be, of the sites before.
        let mut edges: Vec<Vec<u32>> = Vec::with_capacity(self.before.len());
        let mut search = Ancestors::default();
        for (&site, before) in schedule.order.iter().zip(&self.before) {
            let rank = |site: u32| schedule.rank[site as usize];
            let parent = job.parent(site, schedule.way[site as usize]);
            let held = (parent != NONE).then_some(parent);
            let implied = held.into_iter().chain(turn(job, schedule, site)).map(rank);
            let mut kept: Vec<u32> = implied.collect();
            // The latest first: what they wait for themselves goes without saying.
            for &other in before.iter().rev() {
                if kept.contains(&other) || search.reach(&edges, &kept, other) {
                    continue;
                }
                kept.push(other);
                let other = schedule.order[other as usize];
                let is_way = job.corridors.waiting[other as usize]
                    .binary_search(&site)
                    .is_ok();
                let why = if is_way { Why::Way } else { Why::Near };
                afters[site as usize].push(After { site: other, why });
            }
            edges.push(kept);
        }
        afters
    }
}

/// Looks for what others wait for.
#[derive(Default)]
struct Ancestors {
    seen: rustc_hash::FxHashSet<u32>,
    open: Vec<u32>,
}

impl Ancestors {
    /// Whether one of `from` waits for `to`, directly or not; a long way may be missed.
    fn reach(&mut self, edges: &[Vec<u32>], from: &[u32], to: u32) -> bool {
        const MOST: usize = 1000;
        self.seen.clear();
        self.open.clear();
        self.open.extend(from);
        while let Some(at) = self.open.pop() {
            for &before in &edges[at as usize] {
                if before == to {
                    return true;
                }
                if before > to && self.seen.insert(before) {
                    self.open.push(before);
                }
            }
            if self.seen.len() > MOST {
                return false;
            }
        }
        false
    }
}
