//! Schedules that are not made by priorities: another one, in which some sites open at other places of the order or are captured by other
//! faces. Every order in which each site comes behind what holds it and what its way in waits for can be reached so.
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use stochc_ir::Face;

use super::SchedulingJob;
use super::priorities::critical_site;
use crate::schedule::Schedule;
use crate::sites::NONE;

/// Sites that are moved at once, at most.
const MOST: usize = 3;

/// One change in so many is of a way.
const WAYS: u32 = 3;

impl SchedulingJob<'_> {
    /// Another schedule, in which a few sites are elsewhere: mostly such as decide when a run ends. `None`: it came out the same.
    pub fn reinserted(
        &self,
        of: &Schedule,
        critical: &[f32],
        rng: &mut ChaCha8Rng,
    ) -> Option<Schedule> {
        let mut schedule = of.clone();
        let mut has_changed = false;
        for _ in 0..rng.random_range(1..=MOST) {
            let site = critical_site(critical, rng);
            if !self.sites.is_existing(site) {
                has_changed |= match rng.random_range(0..WAYS) {
                    0 => self.recapture(&mut schedule, site, rng),
                    _ => self.insert(&mut schedule, site, rng),
                };
            }
        }
        // Which of several faces near one closes last, for which that one need not wait: as in its own program, or as before.
        if has_changed && rng.random() {
            let waiting = self.waiting(&schedule);
            schedule.set_means(self.sites, self.hardware, self.waits, &waiting);
        }
        has_changed.then_some(schedule)
    }

    /// Has another face capture a site, of what comes before it; whether there is one.
    fn recapture(&self, schedule: &mut Schedule, site: u32, rng: &mut ChaCha8Rng) -> bool {
        let here = site as usize;
        let comes_before = |parent: u32| schedule.rank[parent as usize] < schedule.rank[here];
        let is_other =
            |&way: &Face| way != schedule.way[here] && self.is_way(site, way, comes_before);
        let others: Vec<Face> = Face::ALL.into_iter().filter(is_other).collect();
        if others.is_empty() {
            return false;
        }
        schedule.way[here] = others[rng.random_range(0..others.len())];
        true
    }

    /// Has a site open elsewhere in the order; whether it does.
    fn insert(&self, schedule: &mut Schedule, site: u32, rng: &mut ChaCha8Rng) -> bool {
        let rank = |site: u32| schedule.rank[site as usize] as usize;
        let from = rank(site);
        let parent = Some(schedule.parent(self.sites, site)).filter(|&parent| parent != NONE);
        let before = self.corridors.before(site).chain(parent);
        let first = before.map(|other| rank(other) + 1).max();
        let first = first.unwrap_or(0).max(self.sites.existing_count());
        let held = schedule.children(self.sites, site);
        let behind = held.chain(self.corridors.waiting[site as usize].iter().copied());
        let end = behind.map(rank).min().unwrap_or(schedule.order.len());
        let to = rng.random_range(first..end);
        match to < from {
            true => schedule.order[to..=from].rotate_right(1),
            false => schedule.order[from..=to].rotate_left(1),
        }
        schedule.set_ranks();
        to != from
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand::SeedableRng as _;
    use stochc_grammar::Cancellation;
    use stochc_ir::Cell;
    use stochc_ir::table::Plate;

    use super::super::{Priorities, with_job};
    use super::*;
    use crate::target::held;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

        /// However often it is changed: every site is there once, behind what holds it and what its way in waits for.
        #[test]
        fn an_order_stays_one(
            cells in proptest::collection::vec((0..4, 0..3, 1..4), 2..16),
            seed: u64,
        ) {
            let cells: Vec<Cell> = cells.into_iter().map(|(x, y, z)| Cell::new(x, y, z)).collect();
            let Some(target) = held(cells, &Plate { width: 3, depth: 2 }) else {
                return Ok(());
            };
            with_job(&target, 100, |job| {
                let count = job.sites.len() as u32;
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                let even = Priorities::even(job.sites.len());
                let mut schedule = job.schedule(&even, Cancellation::NEVER).unwrap();
                for _ in 0..20 {
                    let critical = vec![1.0; job.sites.len()];
                    schedule = job.reinserted(&schedule, &critical, &mut rng).unwrap_or(schedule);
                    let rank = |site: u32| schedule.rank[site as usize];
                    prop_assert!((0..count).all(|place| rank(schedule.order[place as usize]) == place));
                    prop_assert_eq!(schedule.order.len() as u32, count);
                    for site in 0..count {
                        let parent = schedule.parent(job.sites, site);
                        let is_held = match parent {
                            NONE => schedule.way[site as usize] == Face::Up && job.sites.is_on_seed(site),
                            parent => rank(parent) < rank(site),
                        };
                        prop_assert!(is_held);
                        let waiting = &job.corridors.waiting[site as usize];
                        prop_assert!(waiting.iter().all(|&other| rank(other) > rank(site)));
                    }
                }
                Ok(())
            })?;
        }
    }
}
