//! Planning of a target for given hardware.
use serde::Serialize;
use stochc_ir::Cell;

use crate::plan::baseline::Baseline;
use crate::plan::capture::Capture;
use crate::scaffold::{Dismantling, SitePart, SiteRoles};
use crate::scaffold_search::{
    NoScaffolds, ScaffoldTrial, Scaffolded, may_have_scaffolds, scaffolded,
};
use crate::scheduling::SchedulingJob;
use crate::search::{FoundSchedule, PlanSearch, search};
use crate::space::free_space::AccessPath;
use crate::space::sites::Sites;
use crate::target::hardware::Hardware;
use crate::timing::makespan::{PlanEstimate, Samples};
use crate::timing::precedence::Waiting;
use crate::timing::rate_law::RateLaw;
use crate::timing::schedule::Schedule;
use crate::{Target, TargetError};

/// Plan: an order of captures that builds a target.
#[derive(Clone, Debug, Serialize)]
pub struct BuildPlan {
    /// Captures of the first phase, in opening order for mean waiting times.
    pub captures: Vec<Capture>,
    /// Second phase, if far parts of the target first grow from scaffolds.
    pub dismantling: Option<Dismantling>,
    /// Estimated completion time, from mean waiting times \[ticks\].
    pub estimate: PlanEstimate,
    /// Largest number of faces that are open at the same time, computed with mean waiting times.
    pub widest: usize,
    /// Number of schedules tried.
    pub rounds: u64,
    /// Baseline that this plan comes from. `None` for the result of a search.
    pub baseline: Option<Baseline>,
    /// Times of the baselines. Empty if they were not computed.
    pub alternatives: Vec<Alternative>,
    /// Result of the search for scaffolds.
    pub scaffolds: ScaffoldTrial,
    /// Times of all plans in a race, including this plan. Empty without a race.
    pub race: Vec<RaceTimes>,
}

/// Times of a plan in simulated runs.
#[derive(Clone, Debug, Serialize)]
pub struct RaceTimes {
    /// Baseline that made the plan. `None` for the result of a search.
    pub baseline: Option<Baseline>,
    /// Number of runs.
    pub runs: u64,
    /// Number of runs that did not complete. Their times until the stop count as completion times.
    pub stopped: u64,
    /// Mean completion time \[ticks\].
    pub mean: f64,
    /// Half-width of the 95 % confidence interval \[ticks\].
    pub error: f64,
}

/// Alternative to the plan: a baseline with its estimated time.
#[derive(Clone, Debug, Serialize)]
pub struct Alternative {
    /// The baseline.
    pub baseline: Baseline,
    /// Estimated completion time if no block jams \[ticks\].
    pub estimate: PlanEstimate,
    /// First diagnostic of its program, if there is one.
    pub diagnostic: Option<&'static str>,
}

/// Returns the number of runs for an estimate. Large targets use fewer.
fn runs(sites: usize) -> usize {
    (400_000 / sites).clamp(16, 1000)
}

/// Plans of a target.
#[derive(Clone, Debug)]
pub struct Plans {
    /// Plan in one phase.
    pub plain: BuildPlan,
    /// Plan with scaffolds, if the estimate favours it.
    pub scaffolded: Option<BuildPlan>,
}

/// Plans a target.
///
/// # Errors
///
/// If no order builds it, or planning is cancelled.
pub fn plan(
    target: &Target,
    hardware: Hardware,
    waits: &RateLaw<'_>,
    how: PlanSearch<'_>,
) -> Result<Plans, TargetError> {
    let sites = Sites::new(target);
    let scaffolds = may_have_scaffolds(target, hardware, how);
    let mut search_plain = how;
    if scaffolds.is_ok() {
        // Half of the time is reserved for scaffolds.
        search_plain.enough = how.halfway;
    }
    let found = search(&sites, hardware, waits, search_plain)?;
    let (scaffolded, trial) = match scaffolds {
        Ok(()) => scaffolded(&sites, &found, hardware, waits, how),
        Err(reason) => (None, ScaffoldTrial::NotTried { reason }),
    };
    let job = found.job(&sites, hardware, waits);
    let plain = BuildPlan::from_found(&job, &found, how.seed);
    let scaffolded = scaffolded.map(|it| BuildPlan::with_scaffolds(it, hardware, waits, how));
    Ok(Plans {
        plain: BuildPlan {
            scaffolds: trial,
            ..plain
        },
        scaffolded,
    })
}

/// Returns the baseline plans. Their access paths are not checked.
pub(crate) fn baseline_plans(
    target: &Target,
    hardware: Hardware,
    waits: &RateLaw<'_>,
    seed: u64,
) -> Vec<(Baseline, BuildPlan)> {
    let sites = Sites::new(target);
    let plans = Baseline::ALL.into_iter().map(|baseline| {
        let (schedule, waiting) = baseline.schedule(&sites, hardware, waits);
        (
            baseline,
            BuildPlan::new(&sites, hardware, &schedule, &waiting, &[], &[], seed),
        )
    });
    plans.collect()
}

impl BuildPlan {
    fn with_scaffolds(
        it: Scaffolded,
        hardware: Hardware,
        waits: &RateLaw<'_>,
        how: PlanSearch<'_>,
    ) -> BuildPlan {
        let Scaffolded {
            scaffolding,
            union,
            found,
        } = it;
        let sites = Sites::new(&union);
        let roles = SiteRoles::new(&sites, &scaffolding);
        let job = found.job(&sites, hardware, waits).with_roles(&roles);
        let mut plan = BuildPlan::from_found(&job, &found, how.seed);
        for capture in &mut plan.captures {
            capture.is_temporary = matches!(roles.part(sites.at(capture.cell)), SitePart::Mast(_));
        }
        let rest = plan.captures.split_off(found.schedule.first_phase);
        BuildPlan {
            dismantling: Some(Dismantling::new(&scaffolding, rest, how.keeps_scaffolds)),
            ..plan
        }
    }

    /// Iterates over the captures of both phases, without handed-over blocks.
    pub fn all_captures(&self) -> impl Iterator<Item = &Capture> {
        let rest = self.dismantling.iter().flat_map(|it| &it.captures);
        self.captures.iter().chain(rest)
    }

    /// Iterates mutably over the captures of both phases, without handed-over blocks.
    pub(crate) fn all_captures_mut(&mut self) -> impl Iterator<Item = &mut Capture> {
        let rest = self.dismantling.iter_mut().flat_map(|it| &mut it.captures);
        self.captures.iter_mut().chain(rest)
    }

    /// Returns the cells of the final structure, sorted.
    pub fn cells(&self) -> Vec<Cell> {
        let are_permanent = self.dismantling.as_ref().is_some_and(|it| it.are_permanent);
        let stays = |capture: &&Capture| are_permanent || !capture.is_temporary;
        let mut cells: Vec<Cell> = (self.all_captures().filter(stays))
            .map(|capture| capture.cell)
            .collect();
        cells.sort_unstable();
        cells
    }

    fn from_found(job: &SchedulingJob<'_>, found: &FoundSchedule, seed: u64) -> BuildPlan {
        let schedule = &found.schedule;
        let waiting = job.waiting(schedule);
        BuildPlan {
            rounds: found.rounds,
            ..BuildPlan::new(
                job.sites,
                job.hardware,
                schedule,
                &waiting,
                &found.corridors.waiting[..],
                &found.disassembly.access_path[..],
                seed,
            )
        }
    }

    /// Returns the plan of a schedule. `on_path` contains the sites on each access path, and
    /// `access_path` the access to each site.
    fn new(
        sites: &Sites<'_>,
        hardware: Hardware,
        schedule: &Schedule,
        waiting: &Waiting,
        on_path: &[Vec<u32>],
        access_path: &[Option<AccessPath>],
        seed: u64,
    ) -> BuildPlan {
        let afters = waiting.afters(sites, hardware, schedule, on_path);
        // A separate seed, independent of the samples that selected the schedule.
        let samples = Samples::new(sites.len(), runs(sites.len()), seed ^ 0x5eed);
        let estimate = samples.estimate(schedule, waiting, &mut Vec::new());
        let decides = samples.criticality(schedule, waiting);
        let missing = schedule.order[sites.existing_count()..].iter();
        let captures = missing.map(|&site| {
            let here = site as usize;
            let after = afters[here].iter();
            Capture {
                cell: sites.cell(site),
                direction: schedule.direction[here],
                wait: f64::from(schedule.mean[here]),
                after: after
                    .map(|after| (sites.cell(after.site), after.why))
                    .collect(),
                is_tight: access_path.get(here).is_some_and(Option::is_none),
                is_temporary: false,
                decides: decides[here],
            }
        });
        BuildPlan {
            captures: captures.collect(),
            dismantling: None,
            estimate,
            widest: widest(waiting, schedule),
            rounds: 0,
            baseline: None,
            alternatives: Vec::new(),
            race: Vec::new(),
            scaffolds: ScaffoldTrial::NotTried {
                reason: NoScaffolds::NotWanted,
            },
        }
    }
}

/// Returns the largest number of faces open at the same time, for mean waiting times.
fn widest(waiting: &Waiting, schedule: &Schedule) -> usize {
    let Schedule {
        order,
        mean,
        first_phase,
        ..
    } = schedule;
    let mut begin = 0.0;
    let mut ends: Vec<f32> = Vec::with_capacity(order.len());
    let mut changes = Vec::with_capacity(2 * order.len());
    for (&site, before) in order.iter().zip(&waiting.before) {
        if ends.len() == *first_phase {
            begin = ends.iter().copied().fold(0.0, f32::max);
        }
        let start = before.iter().map(|&other| ends[other as usize]);
        let start = start.fold(begin, f32::max);
        let end = start + mean[site as usize];
        ends.push(end);
        changes.extend([(start, 1i64), (end, -1)]);
    }
    // Faces that close come before faces that open at the same time.
    changes.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let open = changes.iter().scan(0i64, |open, (_, change)| {
        *open += change;
        Some(*open)
    });
    open.max().unwrap_or(0) as usize
}
