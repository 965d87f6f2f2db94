//! Search for better schedules: varies access paths and priorities, on common random samples.
use rand::RngExt as _;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use stochc_grammar::Cancellation;

use crate::TargetError;
use crate::disassembly::{Disassembly, disassemble};
use crate::scheduling::{Priorities, SchedulingJob, WAIT};
use crate::space::corridor::Corridors;
use crate::space::free_space::FreeSpace;
use crate::space::sites::Sites;
use crate::target::hardware::Hardware;
use crate::target::limits::SMALL;
use crate::timing::makespan::{Objective, PlanEstimate, Samples};
use crate::timing::rate_law::RateLaw;
use crate::timing::schedule::Schedule;

/// Settings of the search.
#[derive(Clone, Copy)]
pub struct PlanSearch<'a> {
    /// Objective to minimize.
    pub objective: Objective,
    /// Largest number of schedules to try. The first schedule is always made.
    pub rounds: u64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Cancellation that ends the search for plans without scaffolds. Not used if scaffolds are
    /// impossible.
    pub halfway: Cancellation<'a>,
    /// Cancellation that ends the search. The result is the best plan so far.
    pub enough: Cancellation<'a>,
    /// Cancellation of planning before the first plan.
    pub cancellation: Cancellation<'a>,
    /// Whether scaffolds remain in the structure.
    pub keeps_scaffolds: bool,
    /// Function that receives the number of schedules tried and the best completion time \[ticks\].
    pub tried: &'a dyn Fn(u64, f64),
}

impl PlanSearch<'_> {
    /// Returns the value for comparing plans: the objective plus the cost of narrow access paths.
    pub(crate) fn value(&self, estimate: &PlanEstimate, disassembly: &Disassembly) -> f64 {
        estimate.value(self.objective) + JAMS * disassembly.narrow_count() as f64
    }
}

impl Default for PlanSearch<'_> {
    /// Returns settings that make only the first plan, with the mean completion time as objective.
    fn default() -> Self {
        PlanSearch {
            objective: Objective::Mean,
            rounds: 1,
            seed: 1,
            halfway: Cancellation::NEVER,
            enough: Cancellation::NEVER,
            cancellation: Cancellation::NEVER,
            keeps_scaffolds: false,
            tried: &|_, _| {},
        }
    }
}

#[derive(Clone, Debug)]
pub struct FoundSchedule {
    /// Construction order, with the access path of each site.
    pub disassembly: Disassembly,
    pub corridors: Corridors,
    /// Opening order of the faces, and the parent of each site.
    pub schedule: Schedule,
    /// Number of schedules tried.
    pub rounds: u64,
}

impl FoundSchedule {
    /// Returns the scheduling job that the schedule solves.
    pub fn job<'a>(
        &'a self,
        sites: &'a Sites<'a>,
        hardware: Hardware,
        waits: &'a RateLaw<'a>,
    ) -> SchedulingJob<'a> {
        SchedulingJob::new(sites, &self.disassembly, &self.corridors, hardware, waits)
    }
}

/// Access paths, and the best schedule for these paths.
struct ScheduleCandidate {
    /// Keys of the sites for the disassembly order. A higher key is removed first.
    order: Vec<f32>,
    /// Whether paths lead through gaps.
    has_gaps: bool,
    disassembly: Disassembly,
    corridors: Corridors,
    scheduled: PrioritizedSchedule,
    value: f64,
}

#[derive(Clone)]
pub struct PrioritizedSchedule {
    pub priorities: Priorities,
    pub schedule: Schedule,
    /// Estimated completion time of the program with this schedule.
    pub estimate: PlanEstimate,
}

/// Returns the number of runs for comparing schedules. Large targets use fewer.
fn runs(sites: usize) -> usize {
    (4000 / sites.max(1)).clamp(32, 128)
}

/// Cost of a cell without a wide access path \[ticks\]. Blocks can jam there. Mean waiting times do
/// not include these jams.
const JAMS: f64 = 20_000.0;

/// Number of disassembly orders to try. They take at most a quarter of the rounds.
const VARIANTS: u64 = 8;

/// Number of consecutive variations of access paths, multiplied by the number of cells. Large
/// targets get fewer variations, so that the effort stays the same.
const PATH_VARIATIONS: u64 = 2000;

/// Number of variations of priorities after each series of variations of access paths.
const PRIORITIES: u64 = 150;

/// Largest number of schedules tried to improve each candidate before the candidates are compared.
const MAX_FIRST: u64 = 1500;

/// Initial relative tolerance: a schedule that is worse by less than this is accepted. Smaller for
/// large targets, where a single change matters less.
const TOLERANCE: f64 = 0.02;

/// Returns the best schedule of a target.
///
/// # Errors
///
/// If there is no schedule, or planning is cancelled before the first schedule.
pub fn search(
    sites: &Sites<'_>,
    hardware: Hardware,
    waits: &RateLaw<'_>,
    search: PlanSearch<'_>,
) -> Result<FoundSchedule, TargetError> {
    let mut searcher = Searcher {
        sites,
        hardware,
        waits,
        search,
        samples: Samples::new(sites.len(), runs(sites.len()), search.seed),
        wide: FreeSpace::new(sites, 2),
        narrow: FreeSpace::new(sites, 1),
        rng: ChaCha8Rng::seed_from_u64(search.seed),
        rounds: 1,
    };
    let best = searcher.vary_orders()?;
    let left = search.rounds.saturating_sub(searcher.rounds);
    let share = (left / (best.len() as u64 + 1)).min(MAX_FIRST);
    let mut found: Option<ScheduleCandidate> = None;
    for first in best {
        let most = searcher.rounds + share;
        let best = searcher.reschedule(first, most);
        found = match found {
            Some(found) if found.value <= best.value => Some(found),
            _ => Some(best),
        };
    }
    let found = searcher.alternate(found.expect("at least one candidate"));
    Ok(FoundSchedule {
        disassembly: found.disassembly,
        corridors: found.corridors,
        schedule: found.scheduled.schedule,
        rounds: searcher.rounds,
    })
}

struct Searcher<'a> {
    sites: &'a Sites<'a>,
    hardware: Hardware,
    waits: &'a RateLaw<'a>,
    search: PlanSearch<'a>,
    samples: Samples,
    /// Free positions of cubes of size two around the complete target.
    wide: FreeSpace,
    /// Free positions of cubes of size one around the complete target.
    narrow: FreeSpace,
    rng: ChaCha8Rng,
    rounds: u64,
}

impl Searcher<'_> {
    /// Returns the access paths and the schedule for one disassembly order and one set of
    /// priorities. `order` contains the keys of the disassembly order.
    fn candidate(
        &self,
        order: Vec<f32>,
        priorities: Priorities,
        has_gaps: bool,
        cancellation: Cancellation<'_>,
    ) -> Result<ScheduleCandidate, TargetError> {
        let wide = self.wide.clone().with_gaps(has_gaps);
        let spaces = [wide, self.narrow.clone()];
        let disassembly = disassemble(self.sites, spaces, &order, cancellation)?;
        let corridors = Corridors::new(self.sites, &disassembly, cancellation)?;
        let (sites, hardware, waits) = (self.sites, self.hardware, self.waits);
        let job = SchedulingJob::new(sites, &disassembly, &corridors, hardware, waits);
        let schedule = job.schedule(&priorities, cancellation)?;
        let waiting = job.waiting(&schedule);
        let scheduled = PrioritizedSchedule {
            estimate: job.estimated(&self.samples, &schedule, &waiting),
            priorities,
            schedule,
        };
        Ok(ScheduleCandidate {
            value: self.search.value(&scheduled.estimate, &disassembly),
            order,
            has_gaps,
            disassembly,
            corridors,
            scheduled,
        })
    }

    fn is_over(&self) -> bool {
        self.rounds >= self.search.rounds || self.search.enough.is_cancelled()
    }

    fn report(&self, best: &ScheduleCandidate) {
        let time = best.scheduled.estimate.value(self.search.objective);
        (self.search.tried)(self.rounds, time);
    }

    /// Tries random disassembly orders. Returns the best schedule with and without gaps. The better
    /// one comes last and gets the remaining time.
    fn vary_orders(&mut self) -> Result<Vec<ScheduleCandidate>, TargetError> {
        let PlanSearch {
            rounds,
            enough,
            cancellation,
            ..
        } = self.search;
        let even = Priorities::even(self.sites.len());
        let mut order = vec![0.5; self.sites.len()];
        let has_gaps = takes_gaps(self.waits, 1);
        let first = self.candidate(order.clone(), even.clone(), has_gaps, cancellation)?;
        // Schedules for both must be improved before they can be compared.
        let mut best = vec![first];
        let each = if self.waits.has_passable_gaps() { 2 } else { 1 };
        let variants = each * VARIANTS;
        while self.rounds < variants && self.rounds * 4 < rounds && !enough.is_cancelled() {
            let kind = (self.rounds % each) as usize;
            if kind == 0 {
                order.fill_with(|| self.rng.random());
            }
            self.rounds += 1;
            self.report(&best[0]);
            let has_gaps = takes_gaps(self.waits, self.rounds);
            match self.candidate(order.clone(), even.clone(), has_gaps, enough) {
                Ok(other) if best.len() == kind => best.push(other),
                Ok(other) if other.value < best[kind].value => best[kind] = other,
                Ok(_) => {}
                Err(_) => break,
            }
        }
        best.sort_by(|a, b| b.value.total_cmp(&a.value));
        Ok(best)
    }

    /// Improves the priorities of a schedule until `most` rounds have been made in the whole
    /// search.
    fn reschedule(&mut self, best: ScheduleCandidate, most: u64) -> ScheduleCandidate {
        let search = PlanSearch {
            rounds: most.min(self.search.rounds),
            ..self.search
        };
        let (sites, hardware, waits) = (self.sites, self.hardware, self.waits);
        let job = SchedulingJob::new(sites, &best.disassembly, &best.corridors, hardware, waits);
        let (samples, rng) = (&self.samples, &mut self.rng);
        let (scheduled, made) = improved(&job, samples, best.scheduled, self.rounds, search, rng);
        self.rounds = made;
        ScheduleCandidate {
            value: search.value(&scheduled.estimate, &best.disassembly),
            scheduled,
            ..best
        }
    }

    /// Alternates between varying the access paths and varying the priorities, until the search
    /// ends.
    fn alternate(&mut self, mut found: ScheduleCandidate) -> ScheduleCandidate {
        while !self.is_over() {
            let most = self.rounds + PATH_VARIATIONS / self.sites.len() as u64;
            while self.rounds < most && !self.is_over() {
                self.rounds += 1;
                self.report(&found);
                let order = rearranged(&found, &mut self.rng);
                let priorities = found.scheduled.priorities.clone();
                match self.candidate(order, priorities, found.has_gaps, self.search.enough) {
                    Ok(other) if other.value <= found.value => found = other,
                    Ok(_) => {}
                    Err(_) => break,
                }
            }
            found = self.reschedule(found, self.rounds + PRIORITIES);
        }
        found
    }
}

/// Returns keys for another disassembly order: a few random changes, or the order of captures with
/// noise.
fn rearranged(of: &ScheduleCandidate, rng: &mut ChaCha8Rng) -> Vec<f32> {
    const MAX: usize = 4;
    /// Largest random delay of a site in the disassembly order \[waiting times\].
    const CHANCE: f32 = 3.0;
    let sites = of.order.len();
    let mut order = of.order.clone();
    if rng.random_range(0..4) == 0 {
        for (key, (end, level)) in
            (order.iter_mut()).zip(of.scheduled.schedule.end.iter().zip(&of.disassembly.level))
        {
            let place = end / WAIT + CHANCE * rng.random::<f32>();
            *key = 0.5 * (place - *level as f32);
        }
    } else {
        for _ in 0..rng.random_range(1..=MAX) {
            order[rng.random_range(0..sites)] += rng.random::<f32>() * 3.0 - 1.5;
        }
    }
    // Urgencies are positive.
    for (key, level) in order.iter_mut().zip(&of.disassembly.level) {
        *key = key.max(-0.5 * *level as f32);
    }
    order
}

/// Returns whether access paths may lead through passable gaps. True for every other variant,
/// because avoiding gaps may give a faster plan.
fn takes_gaps(waits: &RateLaw<'_>, variant: u64) -> bool {
    waits.has_passable_gaps() && variant % 2 == 1
}

/// Improves a schedule by changing priorities. Returns the improved schedule with the number of
/// rounds so far. Accepts slightly worse schedules, with decreasing tolerance.
///
/// # Source
///
/// G. Dueck and T. Scheuer, *Threshold accepting*, Journal of Computational Physics 90 (1990).
pub fn improved(
    job: &SchedulingJob<'_>,
    samples: &Samples,
    mut best: PrioritizedSchedule,
    mut rounds: u64,
    search: PlanSearch<'_>,
    rng: &mut ChaCha8Rng,
) -> (PrioritizedSchedule, u64) {
    let value = |of: &PrioritizedSchedule| of.estimate.value(search.objective);
    let waiting = job.waiting(&best.schedule);
    let mut critical = samples.criticality(&best.schedule, &waiting);
    let mut current = best.clone();
    let from = rounds;
    let tolerance = TOLERANCE * (SMALL as f64 / job.sites.len() as f64).min(1.0);
    while rounds < search.rounds && !search.enough.is_cancelled() {
        rounds += 1;
        (search.tried)(rounds, value(&best));
        let priorities = current.priorities.changed(&critical, rng);
        let schedule = match job.any(&priorities, search.enough) {
            Ok(Some(schedule)) => schedule,
            Ok(None) => continue,
            Err(_) => break,
        };
        let waiting = job.waiting(&schedule);
        let other = PrioritizedSchedule {
            estimate: job.estimated(samples, &schedule, &waiting),
            priorities,
            schedule,
        };
        let left = (search.rounds - rounds) as f64 / (search.rounds - from) as f64;
        let most = value(&best) * (1.0 + tolerance * left);
        // Equal values are accepted as well, to cross plateaus.
        if value(&other) <= most.max(value(&current)) {
            if value(&other) != value(&current) {
                critical = samples.criticality(&other.schedule, &waiting);
            }
            if value(&other) <= value(&best) {
                best = other.clone();
            }
            current = other;
        }
    }
    (best, rounds)
}
