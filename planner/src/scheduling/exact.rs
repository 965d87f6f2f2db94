//! The best of all schedules of a small target, by branch and bound.
//!
//! Whenever a block comes, each face that may open either opens or waits for the next block: that is a tree of all schedules with these
//! ways in. A branch is given up once no schedule in it can be better than the best one known: in each sampled run, a cell comes no sooner
//! than by the shortest chain of waits from what is open, each wait as short as its cell ever allows.
use std::cmp::Reverse;

use stochc_grammar::Cancellation;
use stochc_ir::Face;

use super::{Priorities, ScheduleState, SchedulingJob, SiteState};
use crate::makespan::{Objective, PlanEstimate, Samples};
use crate::precedence::Waiting;
use crate::rate_law::{CellState, Moment};
use crate::schedule::Schedule;
use crate::sites::NONE;

/// A search through all schedules of a job.
pub struct Branching<'a> {
    job: &'a SchedulingJob<'a>,
    samples: &'a Samples,
    objective: Objective,
    enough: Cancellation<'a>,
    /// Of each site, the shortest mean wait that there can be \[ticks\].
    least: Vec<f32>,
    /// How long the best schedule takes \[ticks\].
    value: f64,
    best: Option<Schedule>,
    /// Faces that may still be opened.
    left: u64,
    /// Whether branches are given up; tests look at all of them.
    prunes: bool,
}

/// What came out.
pub struct Searched {
    /// A schedule that is better than what was known.
    pub better: Option<Schedule>,
    /// How long the best one takes \[ticks\].
    pub value: f64,
    /// Faces that may still be opened; 0: the search was not finished.
    pub left: u64,
}

impl<'a> Branching<'a> {
    /// Of a job of no more than [`MOST_SITES`](super::MOST_SITES).
    pub fn new(
        job: &'a SchedulingJob<'a>,
        samples: &'a Samples,
        objective: Objective,
        enough: Cancellation<'a>,
    ) -> Branching<'a> {
        Branching {
            job,
            samples,
            objective,
            enough,
            least: shortest_waits(job),
            value: f64::INFINITY,
            best: None,
            left: 0,
            prunes: true,
        }
    }

    /// Looks for schedules that are better than a value, opening so many faces at most.
    pub fn search(mut self, value: f64, left: u64) -> Searched {
        (self.value, self.left) = (value, left);
        let job = self.job;
        // They decide nothing here.
        let priorities = Priorities::even(job.sites.len());
        let state = job.begin(&priorities);
        self.branch(&state, 0.0, &[], 0);
        Searched {
            better: self.best,
            value: self.value,
            left: self.left,
        }
    }

    /// All schedules that go on from a state at a time; `times`: of the sites that are open or there, in all runs; of the ways that may
    /// open now, those before `from` have been decided.
    fn branch(&mut self, state: &ScheduleState<'_>, now: f32, times: &[f32], from: usize) {
        if state.schedule.order.len() == state.state.len() {
            let schedule = &state.schedule;
            let value = value(self.job, self.samples, schedule, self.objective);
            if value < self.value {
                (self.value, self.best) = (value, Some(schedule.clone()));
            }
            return;
        }
        if self.left == 0 || self.enough.is_cancelled() {
            self.left = 0;
            return;
        }
        if self.prunes && self.bound_of(state, times) >= self.value {
            return;
        }
        for (option, way, mean) in options(state, now, from) {
            if self.left == 0 {
                return;
            }
            self.left -= 1;
            let site = (option / Face::ALL.len()) as u32;
            let mut next = state.clone();
            next.open(site, way, mean, now);
            let mut times = times.to_vec();
            let least = self.least[site as usize];
            self.samples
                .extend(site, least, &before(&next, site), &mut times);
            self.branch(&next, now, &times, option + 1);
        }
        let mut next = state.clone();
        if let Some(Reverse((time, site))) = next.opened.pop() {
            next.anchored(site);
            self.branch(&next, f32::from_bits(time), times, 0);
        }
    }

    /// How long every schedule takes, at least, that goes on from a state.
    fn bound_of(&self, state: &ScheduleState<'_>, times: &[f32]) -> f64 {
        let sites = self.job.sites;
        let runs = self.samples.runs();
        let rank = &state.schedule.rank;
        let mut ends = vec![f32::INFINITY; state.state.len() * runs];
        for (site, end) in ends.chunks_exact_mut(runs).enumerate() {
            match rank[site] {
                NONE if sites.is_on_seed(site as u32) => {
                    let wait = self.samples.waits(site as u32).iter();
                    let pairs = end.iter_mut().zip(wait);
                    pairs.for_each(|(end, wait)| *end = self.least[site] * wait);
                }
                NONE => {}
                place => end.copy_from_slice(&times[place as usize * runs..][..runs]),
            }
        }
        // No chain is longer than there are sites; most are short.
        let absent = || (0..state.state.len()).filter(|&site| rank[site] == NONE);
        let mut has_changed = true;
        while std::mem::take(&mut has_changed) {
            for site in absent() {
                for near in sites.adjacent(site as u32) {
                    let waits = self.samples.waits(site as u32);
                    for run in 0..runs {
                        let chain =
                            ends[near as usize * runs + run] + self.least[site] * waits[run];
                        let end = &mut ends[site * runs + run];
                        if chain < *end {
                            (*end, has_changed) = (chain, true);
                        }
                    }
                }
            }
        }
        self.samples.value(&ends, self.objective)
    }
}

/// What matters of the time that the program of a schedule takes.
pub fn value(
    job: &SchedulingJob<'_>,
    samples: &Samples,
    schedule: &Schedule,
    objective: Objective,
) -> f64 {
    let waiting = job.waiting(schedule);
    estimated(job, samples, schedule, &waiting).of(objective)
}

/// How long the program of a schedule takes, by the mean waits that the estimate of that program has: in the structure as it stands when the turn of
/// each capture comes and all take equally long. Those that a schedule is made with depend on the order in which faces open at the same time.
pub fn estimated(
    job: &SchedulingJob<'_>,
    samples: &Samples,
    schedule: &Schedule,
    waiting: &Waiting,
) -> PlanEstimate {
    // What waits for what is decided before: other means would be those of another program.
    let mut settled = schedule.clone();
    settled.set_means(job.sites, job.hardware, job.waits, waiting);
    samples.estimate(&settled, waiting, &mut Vec::new())
}

/// The faces that may open now: a number by which they are ordered, the way, and the mean wait.
fn options(state: &ScheduleState<'_>, now: f32, from: usize) -> Vec<(usize, Face, f32)> {
    let faces = Face::ALL.len();
    let may_open = |site: &u32| {
        let here = *site as usize;
        (here + 1) * faces > from
            && state.state[here] == SiteState::Absent
            && state.missing[here] == 0
    };
    let sites = (0..state.state.len() as u32).filter(may_open);
    let options = sites.flat_map(|site| {
        let ways = state.ways(site, now);
        ways.map(move |(way, mean)| (site as usize * faces + way as usize, way, mean))
    });
    let mut options: Vec<_> = options.filter(|&(option, ..)| option >= from).collect();
    // What has most behind it opens first: good schedules are found early.
    let tail = |option: usize| state.job.tail[option / faces];
    options.sort_by(|a, b| tail(b.0).total_cmp(&tail(a.0)).then(a.2.total_cmp(&b.2)));
    options
}

/// The places of what a site waits for that has just been opened.
fn before(state: &ScheduleState<'_>, site: u32) -> Vec<u32> {
    let SchedulingJob {
        sites,
        hardware,
        corridors,
        ..
    } = *state.job;
    let schedule = &state.schedule;
    let mut before: Vec<u32> = schedule.held(sites, site).into_iter().collect();
    let rank = |site: u32| schedule.rank[site as usize];
    if hardware.faces == 1 && !hardware.attracts_always {
        let parent = schedule.parent(sites, site);
        let siblings = sites.adjacent(site_or(parent, site)).filter(|&other| {
            parent != NONE
                && other != site
                && rank(other) != NONE
                && schedule.parent(sites, other) == parent
        });
        before.extend(siblings.map(rank));
    }
    let way = schedule.way[site as usize];
    let crowding = state.job.crowding();
    let crowd = crowding.waits(site, way, |near| schedule.before(near, rank(site)));
    before.extend(crowd.into_iter().map(rank));
    before.extend(corridors.before(site).map(rank));
    before
}

fn site_or(parent: u32, site: u32) -> u32 {
    if parent == NONE { site } else { parent }
}

/// Of each site, the shortest mean wait over all ways into it and all that may stand or be awaited around it.
fn shortest_waits(job: &SchedulingJob<'_>) -> Vec<f32> {
    let count = job.sites.len() as u32;
    let moment = Moment {
        free: 1.0,
        is_first: false,
    };
    let least_of = |site: u32| {
        let cell = job.sites.cell(site);
        let mut least = f64::INFINITY;
        // What stands of the target, as bits.
        for full in (0..1u32 << count).filter(|full| full >> site & 1 == 0) {
            for way in Face::ALL {
                let parent = job.parent(site, way);
                let holds = match parent {
                    NONE => way == Face::Up && job.sites.is_on_seed(site),
                    parent => full >> parent & 1 == 1,
                };
                for rest in [CellState::Empty, CellState::Awaited(way)] {
                    if holds {
                        let stands = |at| match job.sites.at(at) {
                            other if other == NONE || other == site => CellState::Empty,
                            other if full >> other & 1 == 1 => CellState::Full,
                            _ => rest,
                        };
                        least = least.min(job.waits.mean(cell, way, moment, stands));
                    }
                }
            }
        }
        least as f32
    };
    (0..count).map(least_of).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use stochc_ir::Cell;
    use stochc_ir::table::Plate;

    use super::super::with_job;
    use super::*;
    use crate::target::held;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

        #[test]
        fn no_schedule_at_all_is_better(cells in proptest::collection::vec((0..3, 0..2, 1..3), 1..6)) {
            let cells: Vec<Cell> = cells.into_iter().map(|(x, y, z)| Cell::new(x, y, z)).collect();
            let Some(target) = held(cells, &Plate { width: 2, depth: 1 }) else {
                return Ok(());
            };
            with_job(&target, 100, |job| {
                let samples = Samples::new(job.sites.len(), 20, 3);
                let of = || Branching::new(job, &samples, Objective::Mean, Cancellation::NEVER);
                let best = of().search(f64::INFINITY, u64::MAX);
                let all = Branching { prunes: false, ..of() }.search(f64::INFINITY, u64::MAX);
                prop_assert!(best.left >= all.left && all.left > 0);
                prop_assert_eq!(best.value, all.value);
                let of = |schedule| value(job, &samples, &schedule, Objective::Mean);
                prop_assert!((of(best.better.unwrap()) - best.value).abs() < 0.01);
                let even = Priorities::even(job.sites.len());
                let listed = job.schedule(&even, Cancellation::NEVER).unwrap();
                prop_assert!(best.value <= of(listed) + 0.01);
                Ok(())
            })?;
        }
    }
}
