//! Better schedules, by trying others: random keys, with the same chance for all.
use rand::RngExt as _;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use stochc_grammar::Cancellation;

use crate::corridor::Corridors;
use crate::disassembly::{Disassembly, disassemble};
use crate::free_space::FreeSpace;
use crate::makespan::{Estimate, Objective, Samples};
use crate::schedule::{Job, Schedule};
use crate::sites::Sites;
use crate::waiting::Waiting;
use crate::waits::RateLaw;
use crate::{Hardware, Refusal};

/// How to look for a plan.
#[derive(Clone, Copy)]
pub struct Search<'a> {
    /// What to make small.
    pub objective: Objective,
    /// Schedules that are tried, at most; the first one is there in any case.
    pub rounds: u64,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Whether it is time to look for scaffolds instead, where there is a place for any.
    pub halfway: Cancellation<'a>,
    /// Whether the best until now is enough.
    pub enough: Cancellation<'a>,
    /// Whether nobody waits for a plan any more, before there is a first one.
    pub cancellation: Cancellation<'a>,
    /// Whether scaffolds stay where they are.
    pub keeps_scaffolds: bool,
    /// Is told how many schedules have been tried, and how long the best takes \[ticks\].
    pub tried: &'a dyn Fn(u64, f64),
}

impl Default for Search<'_> {
    /// The first plan for the mean time, and no other.
    fn default() -> Self {
        Search {
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

/// The best that was found.
#[derive(Debug)]
pub struct Found {
    /// How ways are kept open.
    pub apart: Disassembly,
    /// What waits so that they are.
    pub corridors: Corridors,
    /// In which order, and held by whom.
    pub schedule: Schedule,
    /// Schedules that were tried.
    pub rounds: u64,
}

/// Ways and the best schedule with them.
struct Candidate {
    apart: Disassembly,
    corridors: Corridors,
    keys: Vec<f32>,
    schedule: Schedule,
    value: f64,
    estimate: Estimate,
}

/// Runs by which schedules are compared.
const RUNS: usize = 32;

/// What a cell without a wide way costs: it can jam, which no mean tells \[tick\].
pub const JAMS: f64 = 20_000.0;

/// Ways in are looked for so often, each time in another order, and at most in a quarter of the rounds.
const VARIANTS: u64 = 8;

/// The best schedule of a target.
///
/// # Errors
/// If there is none, or nobody waits for the first one.
pub fn search(
    sites: &Sites<'_>,
    hardware: Hardware,
    waits: &RateLaw<'_>,
    search: Search<'_>,
) -> Result<Found, Refusal> {
    let mut rng = ChaCha8Rng::seed_from_u64(search.seed);
    let samples = Samples::new(sites.len(), RUNS, search.seed);
    let spaces = [FreeSpace::of(sites, 2), FreeSpace::of(sites, 1)];
    let mut times = Vec::new();
    let mut candidate = |order: &[f32], wanted: Cancellation<'_>| -> Result<Candidate, Refusal> {
        let apart = disassemble(sites, spaces.clone(), order, wanted)?;
        let corridors = Corridors::of(sites, &apart, wanted)?;
        let job = Job::new(sites, &apart, &corridors, hardware, waits);
        let keys = vec![0.5; sites.len()];
        let schedule = job.schedule(&keys, wanted)?;
        let estimate = samples.estimate(&schedule, &Waiting::of(&job, &schedule), &mut times);
        Ok(Candidate {
            value: estimate.of(search.objective) + JAMS * apart.tight() as f64,
            apart,
            corridors,
            keys,
            schedule,
            estimate,
        })
    };
    let mut best = candidate(&vec![0.5; sites.len()], search.cancellation)?;
    let mut rounds = 1;
    while rounds < VARIANTS && rounds * 4 < search.rounds && !search.enough.is_cancelled() {
        rounds += 1;
        (search.tried)(rounds, best.estimate.of(search.objective));
        let order: Vec<f32> = (0..sites.len()).map(|_| rng.random()).collect();
        match candidate(&order, search.enough) {
            Ok(other) if other.value < best.value => best = other,
            Ok(_) => {}
            Err(_) => break,
        }
    }
    let job = Job::new(sites, &best.apart, &best.corridors, hardware, waits);
    let start = (best.keys, best.schedule, best.estimate);
    let (schedule, rounds) = improved(&job, &samples, start, rounds, search, &mut rng);
    drop(job);
    Ok(Found {
        apart: best.apart,
        corridors: best.corridors,
        schedule,
        rounds,
    })
}

/// The best schedule of a job that is found by changing keys, and the rounds that were made by then.
pub fn improved(
    job: &Job<'_>,
    samples: &Samples,
    (mut keys, mut schedule, estimate): (Vec<f32>, Schedule, Estimate),
    mut rounds: u64,
    search: Search<'_>,
    rng: &mut ChaCha8Rng,
) -> (Schedule, u64) {
    let mut times = Vec::new();
    let mut value = estimate.of(search.objective);
    let mut critical = samples.criticality(&schedule, &Waiting::of(job, &schedule));
    while rounds < search.rounds && !search.enough.is_cancelled() {
        rounds += 1;
        (search.tried)(rounds, value);
        let changed = changed(&keys, &critical, rng);
        let other = match job.any(&changed, search.enough) {
            Ok(Some(other)) => other,
            Ok(None) => continue,
            Err(_) => break,
        };
        let waiting = Waiting::of(job, &other);
        let estimate = samples.estimate(&other, &waiting, &mut times);
        // Equally good ones as well, to get across plateaus.
        if estimate.of(search.objective) <= value {
            if estimate.of(search.objective) < value {
                critical = samples.criticality(&other, &waiting);
            }
            value = estimate.of(search.objective);
            keys = changed;
            schedule = other;
        }
    }
    (schedule, rounds)
}

/// Keys of which a few are different: mostly of sites that decide when a run ends.
fn changed(keys: &[f32], critical: &[f32], rng: &mut ChaCha8Rng) -> Vec<f32> {
    const MOST: usize = 4;
    let mut keys = keys.to_vec();
    let sites = keys.len();
    for _ in 0..rng.random_range(1..=MOST) {
        // Of three at random, the most critical.
        let mut sites = (0..3).map(|_| rng.random_range(0..sites));
        let first = sites.next().expect("three are drawn");
        let site = sites.fold(first, |a, b| if critical[b] > critical[a] { b } else { a });
        keys[site] = rng.random();
    }
    keys
}
