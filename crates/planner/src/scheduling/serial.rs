//! Serial schedule generation: places sites one by one, the most urgent first, each as early as
//! possible.
//!
//! List scheduling opens any face that may open now. Here a face stays closed for a more urgent one
//! that comes later.
//!
//! # Source
//!
//! R. Kolisch, *Serial and parallel resource-constrained project scheduling methods revisited*,
//! European Journal of Operational Research 90 (1996).
use std::cmp::Reverse;
use std::collections::BinaryHeap;

use stochc_grammar::{Cancellation, Cancelled};
use stochc_ir::{Cell, Face};

use super::{Priorities, SchedulingJob};
use crate::space::crowding::Crowding;
use crate::space::sites::NONE;
use crate::timing::rate_law::{CellState, Moment};
use crate::timing::schedule::Schedule;

/// Largest number of sites for serial schedules, whose cost grows fast.
const MAX_SERIAL: usize = 400;

struct SerialState<'a> {
    job: &'a SchedulingJob<'a>,
    crowding: Crowding<'a>,
    /// For each site, the number of predecessors not yet placed.
    missing: Vec<u32>,
    /// Completion of the last predecessor of each site \[ticks\].
    after: Vec<f32>,
    /// Opening time of each site \[ticks\].
    start: Vec<f32>,
    schedule: Schedule,
}

impl SchedulingJob<'_> {
    /// Returns whether [`SchedulingJob::serial`] supports this job.
    pub fn has_serial(&self) -> bool {
        self.roles.is_none() && self.hardware.faces == 1 && self.sites.len() <= MAX_SERIAL
    }

    /// Returns a schedule that places urgent sites early, or `None` if some site cannot be placed.
    ///
    /// # Errors
    ///
    /// [`Cancelled`] if scheduling is cancelled.
    pub(super) fn serial(
        &self,
        priorities: &Priorities,
        cancellation: Cancellation<'_>,
    ) -> Result<Option<Schedule>, Cancelled> {
        let count = self.sites.len();
        let mut state = SerialState {
            job: self,
            crowding: self.crowding(),
            missing: self.missing(),
            after: vec![0.0; count],
            start: vec![0.0; count],
            schedule: Schedule::empty(count),
        };
        let mut ready: BinaryHeap<(u32, Reverse<u32>)> = BinaryHeap::new();
        let mut is_ready = vec![false; count];
        let consider = |state: &SerialState<'_>,
                        site: u32,
                        ready: &mut BinaryHeap<(u32, Reverse<u32>)>,
                        is_ready: &mut [bool]| {
            let here = site as usize;
            if !is_ready[here] && state.may_be_placed(site) {
                is_ready[here] = true;
                let urgency = priorities.urgency(site, self.tail[here]);
                ready.push((urgency.to_bits(), Reverse(site)));
            }
        };
        for (site, way) in self.sites.existing() {
            is_ready[site as usize] = true;
            state.place(site, way, 0.0, 0.0);
        }
        for site in 0..count as u32 {
            consider(&state, site, &mut ready, &mut is_ready);
        }
        while let Some((_, Reverse(site))) = ready.pop() {
            cancellation.check()?;
            let (way, start, mean) = state.earliest(site, priorities);
            state.place(site, way, start, mean);
            let after = self.corridors.waiting[site as usize].iter().copied();
            for next in after.chain(self.sites.adjacent(site)) {
                consider(&state, next, &mut ready, &mut is_ready);
            }
        }
        Ok((state.schedule.order.len() == count).then(|| state.sorted()))
    }
}

impl SerialState<'_> {
    /// Returns the directions into a site from placed sites.
    fn ways(&self, site: u32) -> impl Iterator<Item = Face> {
        let holds = |parent: u32| self.schedule.rank[parent as usize] != NONE;
        (Face::ALL.into_iter()).filter(move |&way| self.job.is_way(site, way, holds))
    }

    fn may_be_placed(&self, site: u32) -> bool {
        let here = site as usize;
        self.schedule.rank[here] == NONE
            && self.missing[here] == 0
            && self.ways(site).next().is_some()
    }

    /// Returns the direction of the earliest capture, unless priorities select another, with
    /// opening time and waiting time.
    fn earliest(&self, site: u32, priorities: &Priorities) -> (Face, f32, f32) {
        let ways = self.ways(site).map(|way| {
            let start = self.start(site, way);
            let mean = self.mean(site, way, start);
            let price = start + self.job.price(&self.schedule, site, way, mean);
            ((way, start, mean), price)
        });
        let chosen = priorities.chosen(site, ways);
        chosen.expect("the site has a direction")
    }

    /// Returns the earliest opening time of a face.
    fn start(&self, site: u32, way: Face) -> f32 {
        let (job, schedule) = (self.job, &self.schedule);
        let end = |site: u32| schedule.end[site as usize];
        let mut start = self.after[site as usize];
        let parent = job.parent(site, way);
        if parent != NONE {
            start = start.max(end(parent));
            if !job.hardware.attracts_always {
                let siblings = job.sites.adjacent(parent).filter(|&other| {
                    schedule.rank[other as usize] != NONE
                        && job.parent(other, schedule.way[other as usize]) == parent
                });
                start = siblings.map(end).fold(start, f32::max);
            }
        }
        let before = |near: u32| {
            (schedule.rank[near as usize] != NONE)
                .then(|| (schedule.way[near as usize], schedule.end[near as usize]))
        };
        let crowd = self.crowding.waits(site, way, before);
        crowd.into_iter().map(end).fold(start, f32::max)
    }

    fn mean(&self, site: u32, way: Face, start: f32) -> f32 {
        let (job, schedule) = (self.job, &self.schedule);
        let stands = |near: Cell| match job.sites.at(near) {
            NONE => CellState::Empty,
            near if schedule.rank[near as usize] == NONE => CellState::Empty,
            near if schedule.end[near as usize] <= start => CellState::Full,
            near if self.start[near as usize] <= start => {
                CellState::Awaited(schedule.way[near as usize])
            }
            _ => CellState::Empty,
        };
        let bound = schedule.order.len() as f64 / f64::from(job.hardware.free.max(1));
        let moment = Moment {
            free: 1.0 - bound,
            is_first: start == 0.0 && job.sites.target.is_at_rest(),
        };
        job.waits.mean(job.sites.cell(site), way, moment, stands) as f32
    }

    fn place(&mut self, site: u32, way: Face, start: f32, mean: f32) {
        let here = site as usize;
        self.schedule.add(site, way, start, mean);
        self.start[here] = start;
        for &waiting in &self.job.corridors.waiting[here] {
            self.missing[waiting as usize] -= 1;
            let after = &mut self.after[waiting as usize];
            *after = after.max(start + mean);
        }
    }

    /// Sorts the schedule by opening time.
    fn sorted(mut self) -> Schedule {
        let existing = self.job.sites.existing_count();
        let start = &self.start;
        self.schedule.order[existing..]
            .sort_by(|&a, &b| start[a as usize].total_cmp(&start[b as usize]));
        self.schedule.set_ranks();
        self.schedule
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use rand::SeedableRng as _;
    use rand_chacha::ChaCha8Rng;
    use stochc_ir::table::Plate;

    use super::super::with_job;
    use super::*;
    use crate::target::structure::held;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

        /// For any priorities, all sites are placed once, and none opens before its predecessors.
        #[test]
        fn everything_is_placed_behind_what_it_waits_for(
            cells in proptest::collection::vec((0..4, 0..3, 1..4), 1..16),
            seed: u64,
        ) {
            let cells: Vec<Cell> = cells.into_iter().map(|(x, y, z)| Cell::new(x, y, z)).collect();
            let Some(target) = held(cells, &Plate { width: 3, depth: 2 }) else {
                return Ok(());
            };
            with_job(&target, 100, |job| {
                prop_assert!(job.has_serial());
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                let mut priorities = Priorities::even(job.sites.len());
                for _ in 0..4 {
                    priorities = priorities.changed(&vec![1.0; job.sites.len()], true, &mut rng);
                    let serial = job.serial(&priorities, Cancellation::NEVER).unwrap();
                    let schedule = serial.expect("an order that builds it all is known");
                    let mut order = schedule.order.clone();
                    order.sort_unstable();
                    prop_assert!(order.into_iter().eq(0..job.sites.len() as u32));
                    let start = |site: u32| schedule.end[site as usize] - schedule.mean[site as usize];
                    for (&site, before) in schedule.order.iter().zip(&job.waiting(&schedule).before) {
                        let parent = schedule.parent(job.sites, site);
                        prop_assert!(parent == NONE || schedule.end[parent as usize] <= start(site) + 0.1);
                        for &other in before {
                            let other = schedule.order[other as usize];
                            prop_assert!(start(other) <= start(site) + 0.1);
                        }
                    }
                }
                Ok(())
            })?;
        }
    }
}
