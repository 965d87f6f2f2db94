//! Scaffolds that pay: pieces are added one by one, and exchanged, as long as the estimate gets shorter.
use rand::RngExt as _;
use rand::SeedableRng as _;
use rand::seq::SliceRandom as _;
use rand_chacha::ChaCha8Rng;

use super::apart::take_apart;
use super::places::Grown;
use super::{Roles, Scaffolding};
use crate::corridor::Corridors;
use crate::disassembly::Disassembly;
use crate::free_space::FreeSpace;
use crate::makespan::{Estimate, Samples};
use crate::schedule::{Job, Schedule};
use crate::search::{Found, JAMS, Search, improved};
use crate::sites::Sites;
use crate::waiting::Waiting;
use crate::waits::RateLaw;
use crate::{Hardware, Target};

/// A target with scaffolds that pay, and how it is built.
pub struct Scaffolded {
    /// The scaffolds.
    pub scaffolding: Scaffolding,
    /// The cells of the target and of the masts.
    pub union: Target,
    /// The best schedule of it.
    pub found: Found,
}

/// Scaffolds, with a schedule.
struct Candidate {
    scaffolding: Scaffolding,
    union: Target,
    apart: Disassembly,
    corridors: Corridors,
    schedule: Schedule,
    estimate: Estimate,
    value: f64,
}

/// Runs by which scaffolds are compared: their sites differ, and so do their chances.
const RUNS: usize = 200;

/// Tries without which nothing but the first plan is wanted.
const LEAST: u64 = 8;

/// Cells of a target for which scaffolds are looked for, at most.
const MOST_CELLS: usize = 300;

/// The part by which an estimate has to get shorter.
const WORTH: f64 = 0.005;

struct Study<'a> {
    target: &'a Target,
    hardware: Hardware,
    waits: &'a RateLaw<'a>,
    how: Search<'a>,
    tries: u64,
}

/// Looks for scaffolds with which a target is built sooner than by a schedule without; `None`: there are none.
pub fn scaffolded(
    sites: &Sites<'_>,
    without: &Found,
    hardware: Hardware,
    waits: &RateLaw<'_>,
    how: Search<'_>,
) -> Option<Scaffolded> {
    let too_large = sites.len() > MOST_CELLS || sites.len() >= hardware.free as usize;
    if how.rounds < LEAST || too_large || hardware.attracts_always {
        return None;
    }
    let mut study = Study {
        target: sites.target,
        hardware,
        waits,
        how,
        tries: how.rounds,
    };
    let none = Scaffolding::default();
    let grown = Grown::of(sites, &without.schedule, &none);
    let samples = Samples::new(sites.len(), RUNS, how.seed);
    let job = Job::new(sites, &without.apart, &without.corridors, hardware, waits);
    let estimate = samples.estimate(
        &without.schedule,
        &Waiting::of(&job, &without.schedule),
        &mut Vec::new(),
    );
    let value = estimate.of(how.objective) + JAMS * without.apart.tight() as f64;
    let first = study.best_of(&grown, &none, value)?;
    let mut best = study.climbed(first);
    let mut rng = ChaCha8Rng::seed_from_u64(how.seed);
    // The rest is for its schedule.
    while study.tries > how.rounds / 4 && !how.enough.is_cancelled() {
        study.tries -= 1;
        let Some(other) = study.thinned(&best, &mut rng) else {
            continue;
        };
        let other = study.climbed(other);
        if other.value < best.value {
            best = other;
        }
    }
    study.finished(best)
}

impl Study<'_> {
    /// The best of some scaffolds with one more piece, if it is better than a value.
    fn best_of(&mut self, grown: &Grown, of: &Scaffolding, value: f64) -> Option<Candidate> {
        let mut best: Option<Candidate> = None;
        // Where there are too many, chance says which are tried.
        let mut rng = ChaCha8Rng::seed_from_u64(self.how.seed);
        let mut extensions = grown.extensions(self.target, of);
        extensions.shuffle(&mut rng);
        for scaffolding in extensions {
            if self.tries == 0 || self.how.enough.is_cancelled() {
                break;
            }
            self.tries -= 1;
            let least = best
                .as_ref()
                .map_or(value * (1.0 - WORTH), |best| best.value);
            best = (self.candidate(grown, scaffolding))
                .filter(|candidate| candidate.value < least)
                .or(best);
            (self.how.tried)(self.how.rounds - self.tries, least);
        }
        best
    }

    /// The best that is found by adding and exchanging pieces.
    fn climbed(&mut self, mut best: Candidate) -> Candidate {
        while let Some(better) = self.extended(&best).or_else(|| self.exchanged(&best)) {
            best = better;
        }
        best
    }

    /// With some pieces less, to begin from; `None`: there is no schedule of that.
    fn thinned(&self, best: &Candidate, rng: &mut ChaCha8Rng) -> Option<Candidate> {
        let mut scaffolding = best.scaffolding.clone();
        for _ in 0..rng.random_range(1..=3) {
            if scaffolding.pieces.len() > 1 {
                let place = rng.random_range(0..scaffolding.pieces.len());
                scaffolding.pieces.remove(place);
            }
        }
        let sites = Sites::of(&best.union);
        let grown = Grown::of(&sites, &best.schedule, &best.scaffolding);
        self.candidate(&grown, scaffolding)
    }

    fn extended(&mut self, best: &Candidate) -> Option<Candidate> {
        let sites = Sites::of(&best.union);
        let grown = Grown::of(&sites, &best.schedule, &best.scaffolding);
        self.best_of(&grown, &best.scaffolding, best.value)
    }

    /// One piece less, and another one.
    fn exchanged(&mut self, best: &Candidate) -> Option<Candidate> {
        let sites = Sites::of(&best.union);
        (0..best.scaffolding.pieces.len()).find_map(|i| {
            let mut others = best.scaffolding.clone();
            others.pieces.remove(i);
            // What they hold comes as it does with all of them.
            let grown = Grown::of(&sites, &best.schedule, &best.scaffolding);
            self.best_of(&grown, &others, best.value)
        })
    }

    /// A schedule with scaffolds; `None`: there is none, or a mast could not get away.
    fn candidate(&self, grown: &Grown, scaffolding: Scaffolding) -> Option<Candidate> {
        let how = self.how;
        let target = self.target;
        let cells = target.cells().iter().copied();
        let union = target.with_cells(
            cells.chain(scaffolding.cells()).collect(),
            self.hardware.free,
        )?;
        let sites = Sites::of(&union);
        let spaces = [FreeSpace::of(&sites, 2), FreeSpace::of(&sites, 1)];
        if !masts_get_away(&sites, &spaces[0], &scaffolding) {
            return None;
        }
        let roles = Roles::of(&sites, &scaffolding);
        let holders = grown.holders(&sites, &roles);
        let times = grown.times(&sites, &scaffolding);
        let apart = take_apart(&sites, spaces, &holders, &times)?;
        let corridors = Corridors::of(&sites, &apart, how.enough).ok()?;
        let job = Job::new(&sites, &apart, &corridors, self.hardware, self.waits);
        let job = job.with_roles(&roles);
        let keys = vec![0.5; sites.len()];
        let schedule = job.any(&keys, how.enough).ok()??;
        let samples = Samples::new(sites.len(), RUNS, how.seed);
        let waiting = Waiting::of(&job, &schedule);
        let estimate = samples.estimate(&schedule, &waiting, &mut Vec::new());
        Some(Candidate {
            value: estimate.of(how.objective) + JAMS * apart.tight() as f64,
            scaffolding,
            apart,
            corridors,
            schedule,
            estimate,
            union,
        })
    }

    /// The best schedule of the best scaffolds.
    fn finished(self, best: Candidate) -> Option<Scaffolded> {
        let Candidate {
            scaffolding,
            union,
            apart,
            corridors,
            schedule,
            estimate,
            ..
        } = best;
        let sites = Sites::of(&union);
        let roles = Roles::of(&sites, &scaffolding);
        let job = Job::new(&sites, &apart, &corridors, self.hardware, self.waits);
        let job = job.with_roles(&roles);
        let samples = Samples::new(sites.len(), RUNS, self.how.seed);
        let mut rng = ChaCha8Rng::seed_from_u64(self.how.seed);
        let start = (vec![0.5; sites.len()], schedule, estimate);
        let how = Search {
            rounds: self.tries,
            ..self.how
        };
        let (schedule, rounds) = improved(&job, &samples, start, 0, how, &mut rng);
        Some(Scaffolded {
            found: Found {
                rounds: self.how.rounds - self.tries + rounds,
                apart,
                corridors,
                schedule,
                is_best: false,
            },
            union,
            scaffolding,
        })
    }
}

/// Whether the blocks of all masts get away from the target by ways two cells wide, from the top on.
fn masts_get_away(sites: &Sites<'_>, wide: &FreeSpace, scaffolding: &Scaffolding) -> bool {
    let mut space = wide.clone();
    let mut stands = vec![true; sites.len()];
    let mut cells: Vec<_> = scaffolding.cells().collect();
    cells.sort_unstable_by_key(|cell| std::cmp::Reverse(cell.z));
    cells.into_iter().all(|cell| {
        let site = sites.at(cell);
        if !space.has_way(sites, site, &|site| stands[site as usize]) {
            return false;
        }
        stands[site as usize] = false;
        space.open(sites, site, &|site| stands[site as usize], &mut |_| {});
        true
    })
}
