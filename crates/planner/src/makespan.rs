//! How long a schedule takes, by sampling.
use std::cell::RefCell;

use rand::RngExt as _;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rustc_hash::FxHashMap;
use stochc_ir::Cell;
use stochc_rates::LowerBoundReasons;

use crate::precedence::Waiting;
use crate::schedule::Schedule;
use crate::sites::Sites;

/// What a plan should make small.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Objective {
    /// The mean time to completion.
    #[default]
    Mean,
    /// The time in which nine runs of ten are complete.
    P90,
}

/// Times to completion \[ticks\], as far as mean waits tell.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct PlanEstimate {
    /// Their mean.
    pub mean: f64,
    /// The time in which nine runs of ten are complete.
    pub p90: f64,
    /// Whether waits are taken to be as in the default scene, because nobody has measured those of this one: plans are ranked by such times,
    /// which may be off by a factor of fifty.
    pub is_typical: bool,
    /// Whether they are by a first guess of the rates of the scene.
    pub is_first_guess: bool,
    /// Reasons why they are lower bounds. Empty if they are estimates.
    pub lower_bound: LowerBoundReasons,
}

impl PlanEstimate {
    /// What it rests on, where that has to be told.
    pub(crate) fn caveat(&self) -> String {
        let origin = match (self.is_typical, self.is_first_guess) {
            (true, _) => {
                ", if waits were those of the default scene: nobody has measured them in this one"
            }
            (_, true) => ", by a first guess of its waits: nobody has measured them in this scene",
            (false, false) => "",
        };
        if self.lower_bound.is_empty() {
            origin.to_owned()
        } else {
            format!("{origin}: {}", self.lower_bound.text())
        }
    }

    /// The number that matters.
    pub fn of(self, objective: Objective) -> f64 {
        match objective {
            Objective::Mean => self.mean,
            Objective::P90 => self.p90,
        }
    }
}

/// Waits of each site in a few runs, of mean 1: the same for every schedule, so that schedules differ by themselves alone.
#[derive(Clone, Debug)]
pub struct Samples {
    runs: usize,
    /// By site, then by run.
    waits: Vec<f32>,
}

/// So many waits of mean 1.
fn drawn(count: usize, seed: u64) -> impl Iterator<Item = f32> {
    /// A face draws blocks only when the crowd around it has come close: a part of the wait is no exponential.
    const DELAY: f32 = 0.27;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut log = move || -(1.0 - rng.random::<f32>()).ln();
    (0..count).map(move |_| DELAY * 0.5 * (log() + log()) + (1.0 - DELAY) * log())
}

/// Waits by cell, so that targets whose sites are not the same differ by their schedules alone.
#[derive(Debug)]
pub struct CellSamples {
    runs: usize,
    seed: u64,
    known: RefCell<FxHashMap<Cell, Vec<f32>>>,
}

impl CellSamples {
    /// So many runs, of a seed.
    pub fn new(runs: usize, seed: u64) -> CellSamples {
        CellSamples {
            runs,
            seed,
            known: RefCell::default(),
        }
    }

    /// The samples of some sites.
    pub fn of(&self, sites: &Sites<'_>) -> Samples {
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
    /// So many runs of so many sites, of a seed.
    pub fn new(sites: usize, runs: usize, seed: u64) -> Samples {
        let waits = drawn(sites * runs, seed).collect();
        Samples { runs, waits }
    }

    /// The times of each site in each run, in the order in which sites open \[ticks\].
    fn times(&self, schedule: &Schedule, waiting: &Waiting, times: &mut Vec<f32>) {
        let runs = self.runs;
        times.clear();
        times.reserve(schedule.order.len() * runs);
        // When the phase before is over.
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

    /// The waits of a site in all runs, of mean 1.
    fn waits(&self, site: u32) -> &[f32] {
        &self.waits[site as usize * self.runs..][..self.runs]
    }

    /// Turns the last times, when a site may begin to wait at the earliest, into when its block comes.
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

    /// How long a schedule takes; `times` is working space.
    pub fn estimate(
        &self,
        schedule: &Schedule,
        waiting: &Waiting,
        times: &mut Vec<f32>,
    ) -> PlanEstimate {
        self.times(schedule, waiting, times);
        self.summed_up(times)
    }

    /// How often each site, by number, decided when a run ended: it is on the chain of what was waited for last.
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
