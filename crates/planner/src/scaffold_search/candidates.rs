//! Searches for scaffolds that make a plan faster.
use rand::RngExt as _;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use super::leaf_peeling::peel_leaves;
use super::places::{GrowthSchedule, has_place};
use super::trial::{MAX_CELLS, NoScaffolds, ScaffoldTrial};
use crate::disassembly::Disassembly;
use crate::scaffold::{Scaffolding, SiteRoles};
use crate::scheduling::{Priorities, SchedulingJob};
use crate::search::{FoundSchedule, PlanSearch, PrioritizedSchedule, improved};
use crate::space::corridor::Corridors;
use crate::space::free_space::FreeSpace;
use crate::space::sites::Sites;
use crate::timing::makespan::{CellSamples, PlanEstimate, Samples};
use crate::timing::rate_law::RateLaw;
use crate::timing::schedule::Schedule;
use crate::{Hardware, Target};

/// Target with useful scaffolds, and its schedule.
pub struct Scaffolded {
    pub scaffolding: Scaffolding,
    /// The target together with the cells of the masts.
    pub union: Target,
    pub found: FoundSchedule,
}

struct ScaffoldCandidate {
    pub(super) scaffolding: Scaffolding,
    union: Target,
    pub(super) disassembly: Disassembly,
    corridors: Corridors,
    pub(super) schedule: Schedule,
    estimate: PlanEstimate,
    value: f64,
}

/// Number of runs for comparing scaffolds.
const RUNS: usize = 200;

/// Smallest number of tries for a search. A caller that allows fewer tries wants only the first
/// plan.
const MIN: u64 = 8;

/// Required relative improvement of the estimate.
const WORTH: f64 = 0.005;

/// Smallest limit to try. Cells with at most this number of captures from the plate need no mast.
const MIN_LIMIT: usize = 2;

/// Number of tries of one search. Further tries are made with other seeds.
const TRIES: u64 = 3000;

/// Fraction of the tries that is left when the exchange of segments begins.
const EXCHANGES: f64 = 0.8;

/// Fraction of the tries that is left when the search for schedules begins.
const SCHEDULES: f64 = 0.2;

/// Initial tolerance of the exchange, relative to the best value.
const TOLERANCE: f64 = 0.03;

struct ScaffoldTrials<'a> {
    pub(super) target: &'a Target,
    hardware: Hardware,
    waits: &'a RateLaw<'a>,
    how: PlanSearch<'a>,
    /// Samples common to all candidates.
    samples: CellSamples,
    /// Number of tries in earlier searches.
    before: u64,
    /// Number of tries of this search.
    pub(super) all: u64,
    /// Number of tries that are left.
    pub(super) tries: u64,
}

/// Checks whether a search for scaffolds is possible.
///
/// # Errors
///
/// Returns the reason why it is not.
pub(crate) fn may_have_scaffolds(
    target: &Target,
    hardware: Hardware,
    how: PlanSearch<'_>,
) -> Result<(), NoScaffolds> {
    has_place(target)?;
    let cells = target.cells().len();
    match () {
        () if cells > MAX_CELLS => Err(NoScaffolds::TooLarge),
        () if cells >= hardware.free as usize => Err(NoScaffolds::NoSpareBlocks),
        () if hardware.attracts_always => Err(NoScaffolds::AttractsAlways),
        () if how.rounds < MIN => Err(NoScaffolds::FewTries),
        () => Ok(()),
    }
}

/// Searches for scaffolds that shorten the completion of a target, and reports their gain.
pub(crate) fn scaffolded(
    sites: &Sites<'_>,
    without: &FoundSchedule,
    hardware: Hardware,
    waits: &RateLaw<'_>,
    how: PlanSearch<'_>,
) -> (Option<Scaffolded>, ScaffoldTrial) {
    let mut trials = ScaffoldTrials {
        target: sites.target,
        hardware,
        waits,
        how,
        samples: CellSamples::new(RUNS, how.seed),
        before: 0,
        all: 0,
        tries: 0,
    };
    let growth = GrowthSchedule::new(sites, &without.schedule, &Scaffolding::default());
    let samples = trials.samples.for_sites(sites);
    let job = without.job(sites, hardware, waits);
    let estimate = trials.estimated(&job, &samples, &without.schedule);
    let value = trials.how.value(&estimate, &without.disassembly);
    let mut best: Option<(f64, Scaffolded)> = None;
    let mut tried: Option<f64> = None;
    for seed in (0..).map(|number| how.seed.wrapping_add(number)) {
        trials.before += trials.all;
        trials.all = (how.rounds - trials.before).min(TRIES);
        trials.tries = trials.all;
        if trials.all < MIN || how.enough.is_cancelled() {
            break;
        }
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let Some(first) = trials.balanced(&growth, value, &mut rng) else {
            break;
        };
        let found = trials.exchanged(first, &mut rng);
        let with = found.estimate.value(how.objective);
        tried = Some(tried.map_or(with, |least| least.min(with)));
        if found.value < value * (1.0 - WORTH) {
            let other = trials.finished(found, seed);
            best = match best {
                Some(best) if best.0 <= other.0 => Some(best),
                _ => Some(other),
            };
        }
    }
    let trial = match tried {
        Some(with) => ScaffoldTrial::Tried {
            without: estimate.value(how.objective),
            with,
            is_used: false,
        },
        None => ScaffoldTrial::NotTried {
            reason: NoScaffolds::NoneFound,
        },
    };
    (best.map(|(_, scaffolded)| scaffolded), trial)
}

impl ScaffoldTrials<'_> {
    /// Estimates the completion time of a schedule's program.
    fn estimated(
        &self,
        job: &SchedulingJob<'_>,
        samples: &Samples,
        schedule: &Schedule,
    ) -> PlanEstimate {
        job.estimated(samples, schedule, &job.waiting(schedule))
    }

    /// Returns the fraction of tries left.
    fn left(&self) -> f64 {
        self.tries as f64 / self.all as f64
    }

    /// Uses one try if the fraction of tries left is larger than `part`. Returns whether a try was
    /// used.
    fn may_try(&mut self, part: f64, value: f64) -> bool {
        let may = self.left() > part && !self.how.enough.is_cancelled();
        if may {
            self.tries -= 1;
            (self.how.tried)(self.before + self.all - self.tries, value);
        }
        may
    }

    /// Returns the best of several balanced scaffolds, or `None` if there are none.
    pub(super) fn balanced(
        &mut self,
        growth: &GrowthSchedule,
        value: f64,
        rng: &mut ChaCha8Rng,
    ) -> Option<ScaffoldCandidate> {
        let deepest = growth.far_first().first()?.1;
        let mut best: Option<ScaffoldCandidate> = None;
        for limit in (MIN_LIMIT..deepest).cycle() {
            let least = best.as_ref().map_or(f64::INFINITY, |best| best.value);
            if !self.may_try(EXCHANGES, least.min(value)) {
                break;
            }
            let have_guides = rng.random();
            let mut scaffolding = growth.balanced(self.target, limit, have_guides, rng);
            if have_guides {
                // Also guides next to the target.
                scaffolding = scaffolding.guided(self.target, rng).unwrap_or(scaffolding);
            }
            if !scaffolding.is_empty() {
                let candidate = self.candidate(growth, scaffolding);
                best = candidate.filter(|it| it.value < least).or(best);
            }
        }
        best
    }

    /// Exchanges segments and returns the best scaffolds. Early on, slightly worse values are
    /// accepted.
    fn exchanged(
        &mut self,
        mut best: ScaffoldCandidate,
        rng: &mut ChaCha8Rng,
    ) -> ScaffoldCandidate {
        let mut current: Option<ScaffoldCandidate> = None;
        while self.may_try(SCHEDULES, best.value) {
            let from = current.as_ref().unwrap_or(&best);
            let Some(other) = self.neighbour(from, rng) else {
                continue;
            };
            if other.value < best.value {
                best = other;
                current = None;
            } else if other.value < best.value * (1.0 + TOLERANCE * (self.left() - SCHEDULES)) {
                current = Some(other);
            }
        }
        best
    }

    /// Returns scaffolds with some segments removed and other segments added. Returns `None` if the
    /// change is not possible.
    pub(super) fn neighbour(
        &self,
        of: &ScaffoldCandidate,
        rng: &mut ChaCha8Rng,
    ) -> Option<ScaffoldCandidate> {
        let sites = Sites::new(&of.union);
        let growth = GrowthSchedule::new(&sites, &of.schedule, &of.scaffolding);
        let mut scaffolding = of.scaffolding.clone();
        if rng.random_range(0..3) == 0 {
            for _ in 0..rng.random_range(1..=2) {
                let other = if rng.random() {
                    scaffolding.guided(self.target, rng)
                } else {
                    scaffolding.unguided(rng)
                };
                scaffolding = other.unwrap_or(scaffolding);
            }
            return (!scaffolding.is_empty())
                .then(|| self.candidate(&growth, scaffolding))
                .flatten();
        }
        let mut near = Vec::new();
        for _ in 0..rng.random_range(0..=2) {
            if scaffolding.segments.len() > 1 {
                let place = rng.random_range(0..scaffolding.segments.len());
                let segment = scaffolding.segments.remove(place);
                if rng.random() {
                    near.extend(segment.cells);
                }
            }
        }
        for _ in 0..rng.random_range(0..=2) {
            if let Some(more) = growth.extended(self.target, &scaffolding, &near, rng) {
                scaffolding = more;
            }
        }
        if scaffolding == of.scaffolding {
            None
        } else {
            self.candidate(&growth, scaffolding)
        }
    }

    /// Returns the candidate for a scaffolding. Returns `None` if it has no schedule, or if a mast
    /// could not be removed afterwards.
    fn candidate(
        &self,
        growth: &GrowthSchedule,
        scaffolding: Scaffolding,
    ) -> Option<ScaffoldCandidate> {
        let how = self.how;
        let target = self.target;
        let cells = target.cells().iter().copied();
        let union = target.with_cells(
            cells.chain(scaffolding.cells()).collect(),
            self.hardware.free,
        )?;
        let sites = Sites::new(&union);
        let spaces = [FreeSpace::new(&sites, 2), FreeSpace::new(&sites, 1)];
        if !masts_get_away(&sites, &spaces[0], &scaffolding) {
            return None;
        }
        let roles = SiteRoles::new(&sites, &scaffolding);
        let holders = growth.holders(&sites, &roles);
        let times = growth.times(&sites, &scaffolding);
        let disassembly = peel_leaves(&sites, spaces, &holders, &times)?;
        let corridors = Corridors::new(&sites, &disassembly, how.enough).ok()?;
        let job = SchedulingJob::new(&sites, &disassembly, &corridors, self.hardware, self.waits);
        let job = job.with_roles(&roles);
        let even = Priorities::even(sites.len());
        let schedule = job.any(&even, how.enough).ok()??;
        let samples = self.samples.for_sites(&sites);
        let estimate = self.estimated(&job, &samples, &schedule);
        Some(ScaffoldCandidate {
            value: how.value(&estimate, &disassembly),
            scaffolding,
            disassembly,
            corridors,
            schedule,
            estimate,
            union,
        })
    }

    /// Returns the best schedule of the best scaffolds, and its value.
    fn finished(&self, best: ScaffoldCandidate, seed: u64) -> (f64, Scaffolded) {
        let ScaffoldCandidate {
            scaffolding,
            union,
            disassembly,
            corridors,
            schedule,
            estimate,
            ..
        } = best;
        let sites = Sites::new(&union);
        let roles = SiteRoles::new(&sites, &scaffolding);
        let job = SchedulingJob::new(&sites, &disassembly, &corridors, self.hardware, self.waits);
        let job = job.with_roles(&roles);
        let samples = self.samples.for_sites(&sites);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let start = PrioritizedSchedule {
            priorities: Priorities::even(sites.len()),
            schedule,
            estimate,
        };
        let how = PlanSearch {
            rounds: self.before + self.all,
            ..self.how
        };
        let tried = how.rounds - self.tries;
        let (found, rounds) = improved(&job, &samples, start, tried, how, &mut rng);
        let value = how.value(&found.estimate, &disassembly);
        let scaffolded = Scaffolded {
            found: FoundSchedule {
                rounds,
                disassembly,
                corridors,
                schedule: found.schedule,
            },
            union,
            scaffolding,
        };
        (value, scaffolded)
    }
}

/// Returns whether all masts can be removed from the top, by paths two cells wide.
fn masts_get_away(sites: &Sites<'_>, wide: &FreeSpace, scaffolding: &Scaffolding) -> bool {
    let mut space = wide.clone();
    let mut stands = vec![true; sites.len()];
    let mut cells: Vec<_> = scaffolding.cells().collect();
    cells.sort_unstable_by_key(|cell| std::cmp::Reverse(cell.z));
    cells.into_iter().all(|cell| {
        let site = sites.at(cell);
        if (space.access_path(sites, site, &|site| stands[site as usize])).is_none() {
            return false;
        }
        stands[site as usize] = false;
        space.open(sites, site, &|site| stands[site as usize], &mut |_| {});
        true
    })
}
