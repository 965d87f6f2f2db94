//! Completion time of a schedule by sampling.
use std::cell::RefCell;

use rand::RngExt as _;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rustc_hash::FxHashMap;
use stochc_estimate::LowerBoundReasons;
use stochc_ir::Cell;

use crate::space::sites::Sites;
use crate::timing::precedence::Waiting;
use crate::timing::schedule::Schedule;

/// Objective of a plan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Objective {
    /// Mean completion time.
    #[default]
    Mean,
    /// 90th percentile of the completion time.
    P90,
}

/// Estimated completion time, from mean waiting times \[ticks\].
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct PlanEstimate {
    /// Mean.
    pub mean: f64,
    /// 90th percentile.
    pub p90: f64,
    /// Whether the waiting times come from the default scene, because this scene has not been
    /// calibrated. Such times rank plans, but may be off by a factor of fifty.
    pub is_typical: bool,
    /// Whether the rates are uncalibrated estimates.
    pub is_first_guess: bool,
    /// Reasons why the times are lower bounds. Empty if they are estimates.
    pub lower_bound: LowerBoundReasons,
}

impl PlanEstimate {
    /// Returns the mean and the 90th percentile in words, with a `separator` between them. In a
    /// scene that has not been calibrated, returns why they are unknown.
    pub(crate) fn in_words(&self, separator: &str) -> String {
        if self.is_typical {
            return "no estimate, because this scene has not been calibrated (`stochc calibrate`)"
                .to_owned();
        }
        let bound = if self.lower_bound.is_empty() {
            "about"
        } else {
            "at least"
        };
        let (mean, p90, caveat) = (self.mean, self.p90, self.caveat());
        format!("{bound} {mean:.0} ticks{separator} nine of ten runs within {p90:.0}{caveat}")
    }

    /// Returns the caveat of the estimate. Empty without a caveat.
    fn caveat(&self) -> String {
        let origin = if self.is_first_guess {
            ", by an uncalibrated estimate of its waiting times"
        } else {
            ""
        };
        if self.lower_bound.is_empty() {
            origin.to_owned()
        } else {
            format!("{origin}: {}", self.lower_bound.text())
        }
    }

    /// Returns the time that an objective selects.
    pub fn value(self, objective: Objective) -> f64 {
        match objective {
            Objective::Mean => self.mean,
            Objective::P90 => self.p90,
        }
    }
}

/// Random waiting times of each site in a few runs, with mean 1. All schedules use the same random
/// times, so that only the schedules cause differences.
#[derive(Clone, Debug)]
pub struct Samples {
    runs: usize,
    /// Waiting times by site, then by run.
    waits: Vec<f32>,
}

/// Returns `count` samples with mean 1.
fn drawn(count: usize, seed: u64) -> impl Iterator<Item = f32> {
    /// Constant fraction of a waiting time: nearby blocks must first come closer.
    const DELAY: f32 = 0.27;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut log = move || -(1.0 - rng.random::<f32>()).ln();
    (0..count).map(move |_| DELAY * 0.5 * (log() + log()) + (1.0 - DELAY) * log())
}

/// Waiting times by cell. Targets with different sites thus share samples.
#[derive(Debug)]
pub struct CellSamples {
    runs: usize,
    seed: u64,
    known: RefCell<FxHashMap<Cell, Vec<f32>>>,
}

impl CellSamples {
    /// Returns samples of this number of runs from a seed.
    pub fn new(runs: usize, seed: u64) -> CellSamples {
        CellSamples {
            runs,
            seed,
            known: RefCell::default(),
        }
    }

    pub fn for_sites(&self, sites: &Sites<'_>) -> Samples {
        let mut known = self.known.borrow_mut();
        let mut waits = Vec::with_capacity(sites.len() * self.runs);
        for site in 0..sites.len() as u32 {
            let cell = sites.cell(site);
            let number = known.len() as u64;
            let of_cell = || drawn(self.runs, self.seed.wrapping_add(number)).collect();
            waits.extend_from_slice(known.entry(cell).or_insert_with(of_cell));
        }
        Samples {
            runs: self.runs,
            waits,
        }
    }
}

impl Samples {
    pub fn new(sites: usize, runs: usize, seed: u64) -> Samples {
        let waits = drawn(sites * runs, seed).collect();
        Samples { runs, waits }
    }

    /// Computes the completion time of each site in each run, in opening order \[ticks\].
    fn times(&self, schedule: &Schedule, waiting: &Waiting, times: &mut Vec<f32>) {
        let runs = self.runs;
        times.clear();
        times.reserve(schedule.order.len() * runs);
        // Ends of the previous phase.
        let mut begin = vec![0.0f32; runs];
        for (i, (&site, before)) in schedule.order.iter().zip(&waiting.before).enumerate() {
            if i == schedule.first_phase {
                for times in times.chunks_exact(runs) {
                    let pairs = begin.iter_mut().zip(times);
                    pairs.for_each(|(begin, &time)| *begin = begin.max(time));
                }
            }
            times.extend_from_slice(&begin);
            self.wait(site, schedule.mean[site as usize], before, times);
        }
    }

    /// Returns the waiting times of a site in all runs, with mean 1.
    fn waits(&self, site: u32) -> &[f32] {
        &self.waits[site as usize * self.runs..][..self.runs]
    }

    /// Adds a waiting time to each of the last values of `times`, one value per run. On entry,
    /// these values are the start of the phase. On return, they are the capture times of the site.
    fn wait(&self, site: u32, mean: f32, before: &[u32], times: &mut [f32]) {
        let runs = self.runs;
        let (done, here) = times.split_at_mut(times.len() - runs);
        for &other in before {
            let other = &done[other as usize * runs..][..runs];
            for (here, &other) in here.iter_mut().zip(other) {
                *here = here.max(other);
            }
        }
        for (here, &wait) in here.iter_mut().zip(self.waits(site)) {
            *here += mean * wait;
        }
    }

    fn summed_up(&self, times: &[f32]) -> PlanEstimate {
        let mut ends = vec![0.0f32; self.runs];
        for times in times.chunks_exact(self.runs) {
            for (end, &time) in ends.iter_mut().zip(times) {
                *end = end.max(time);
            }
        }
        ends.sort_unstable_by(f32::total_cmp);
        let sum: f64 = ends.iter().map(|&end| f64::from(end)).sum();
        let place = (self.runs * 9).div_ceil(10).max(1) - 1;
        PlanEstimate {
            mean: sum / self.runs as f64,
            p90: f64::from(ends[place]),
            is_typical: false,
            is_first_guess: false,
            lower_bound: LowerBoundReasons::default(),
        }
    }

    /// Estimates the completion time of a schedule. `times` is a buffer.
    pub fn estimate(
        &self,
        schedule: &Schedule,
        waiting: &Waiting,
        times: &mut Vec<f32>,
    ) -> PlanEstimate {
        self.times(schedule, waiting, times);
        self.summed_up(times)
    }

    /// Returns the fraction of runs with each site on the critical path, by site.
    pub fn criticality(&self, schedule: &Schedule, waiting: &Waiting) -> Vec<f32> {
        let mut times = Vec::new();
        self.times(schedule, waiting, &mut times);
        let runs = self.runs;
        let mut counts = vec![0.0; schedule.order.len()];
        let at = |place: usize, run: usize| times[place * runs + run];
        for run in 0..runs {
            let last = (0..schedule.order.len()).max_by(|&a, &b| at(a, run).total_cmp(&at(b, run)));
            let mut next = last;
            while let Some(place) = next {
                counts[schedule.order[place] as usize] += 1.0 / runs as f32;
                let later = |a: &usize, b: &usize| at(*a, run).total_cmp(&at(*b, run));
                let before = waiting.before[place].iter().map(|&other| other as usize);
                next = before.max_by(later);
                if next.is_none() && place >= schedule.first_phase {
                    next = (0..schedule.first_phase).max_by(later);
                }
            }
        }
        counts
    }
}
