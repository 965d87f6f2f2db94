//! Races between plans: physical simulations determine the fastest plan.
//!
//! # Source
//! O. Maron and A. W. Moore, *Hoeffding races*, Advances in Neural Information Processing Systems
//! 6, 1994.
use std::cmp::Ordering::Less;
use std::sync::atomic::Ordering;

use stochc_experiments::completion_time;
use stochc_experiments::statistics::{Summary, quantile};
use stochc_ir::record::RunRecord;
use stochc_planner::{BuildPlan, Objective, RaceTimes, race_to_text};
use stochc_results::{EnsembleProgram, Manifest};
use stochc_runtime::Settings;

use super::PlanOptions;
use crate::check_text;
use crate::exit::Failure;
use crate::host::Host;
use crate::operations::in_memory::all_runs;
use stochc_planner::Planned;

/// Smallest number of runs of a plan in a race. The first round has this number.
pub const MIN_RACE: u64 = 8;

/// Largest number of runs of a plan in a race.
pub const MAX_RACE: u64 = 100_000;

/// Limit on the difference between a plan's mean time and the fastest plan's mean time. The unit is
/// the half-width of the difference's confidence interval. A plan above the limit leaves the race.
/// The limit is above 1, because plans are compared after each round.
const MAX_BEHIND: f64 = 1.5;

/// Limit on the ticks of a run, as a multiple of its plan's estimated time.
const MAX_ESTIMATES: f64 = 12.0;

/// Plan in a race, with its runs.
struct Entrant {
    planned: Planned,
    program: EnsembleProgram,
    times: Vec<f64>,
    stopped: u64,
}

/// Returns the fastest plan: `planned` or one of its rivals. A rival with a stopped run never wins.
///
/// `planned` itself never leaves the race: a few runs of a rival may not show its rare, long jams.
/// If the user interrupts the race, `planned` wins.
///
/// # Errors
/// If a program does not compile, or its scene cannot be set up.
pub fn winner(
    planned: Planned,
    rivals: Vec<Planned>,
    runs: u64,
    options: &PlanOptions<'_>,
    host: &dyn Host,
) -> Result<Planned, Failure> {
    let settings = Settings {
        max_ticks: Some((MAX_ESTIMATES * planned.plan.estimate.mean) as u64),
        ..Settings::default()
    };
    let own = planned.plan.baseline;
    let rivals = rivals.into_iter().filter(|it| it.plan.baseline != own);
    let rivals = rivals.map(Entrant::new).collect::<Result<Vec<_>, _>>()?;
    // `planned` is the first plan in the race.
    let mut running = vec![Entrant::new(planned)?];
    running.extend(rivals);
    let mut slow: Vec<RaceTimes> = Vec::new();
    let mut made = 0;
    for round in 0.. {
        let more = made.max(MIN_RACE).min(runs - made);
        let seed = options.seed.wrapping_add(round << 32);
        let programs = running.iter().map(|it| it.program.clone()).collect();
        let manifest = Manifest::new(settings.clone(), seed, more, programs);
        let results = all_runs(&manifest, None, "no plan was chosen", host);
        if host.stop().load(Ordering::Relaxed) {
            running.truncate(1);
            break;
        }
        for run in results?.finished.to_vec().map_err(Failure::usage)? {
            running[run.program].add(&run.record);
        }
        made += more;
        slow.extend(remove_slow(&mut running));
        if made == runs || running.len() == 1 {
            break;
        }
    }
    let race: Vec<RaceTimes> = running
        .iter()
        .map(Entrant::race_times)
        .chain(slow)
        .collect();
    let planned = fastest(running, options.objective);
    host.note(&race_to_text(&race));
    Ok(Planned {
        plan: BuildPlan {
            race,
            ..planned.plan
        },
        ..planned
    })
}

/// Removes rivals that are clearly slower than another plan or have a stopped run. Returns the
/// times of removed plans.
fn remove_slow(running: &mut Vec<Entrant>) -> Vec<RaceTimes> {
    let times: Vec<RaceTimes> = running.iter().map(Entrant::race_times).collect();
    let best = times.iter().min_by(|a, b| a.mean.total_cmp(&b.mean));
    let Some(best) = best else {
        return Vec::new();
    };
    let is_slow = |own: &RaceTimes| {
        own.stopped > 0 || own.mean - best.mean > MAX_BEHIND * own.error.hypot(best.error)
    };
    let out: Vec<bool> = (times.iter().enumerate())
        .map(|(place, own)| place > 0 && is_slow(own))
        .collect();
    let mut places = out.iter();
    running.retain(|_| places.next() == Some(&false));
    let slow = times.into_iter().zip(out).filter(|(_, is_out)| *is_out);
    slow.map(|(times, _)| times).collect()
}

/// Returns the fastest plan. Of several equally fast plans, returns the first. The result receives
/// the messages of the first plan in the race. These messages are valid for all plans.
fn fastest(mut running: Vec<Entrant>, objective: Objective) -> Planned {
    let first = running.remove(0);
    let mut best = first.value(objective);
    let mut planned = first.planned;
    for rival in running {
        let value = rival.value(objective);
        if value.total_cmp(&best) == Less {
            let BuildPlan {
                rounds,
                alternatives,
                scaffolds,
                ..
            } = planned.plan;
            planned = rival.planned;
            planned.plan.rounds = rounds;
            planned.plan.alternatives = alternatives;
            planned.plan.scaffolds = scaffolds.unused();
            best = value;
        }
    }
    planned
}

impl Entrant {
    fn new(planned: Planned) -> Result<Entrant, Failure> {
        let programs = crate::compile(check_text(&planned.name, &planned.text));
        let program = programs.ok().and_then(|mut programs| programs.pop());
        let program = program.ok_or_else(|| Failure::usage("the planned program is wrong"))?;
        Ok(Entrant {
            program: EnsembleProgram::new(&planned.assembly, Vec::new(), program),
            planned,
            times: Vec::new(),
            stopped: 0,
        })
    }

    fn add(&mut self, record: &RunRecord) {
        let is_completed = completion_time(record).is_some_and(|it| it.is_completed());
        self.stopped += u64::from(!is_completed);
        self.times.push(record.ticks as f64);
    }

    fn race_times(&self) -> RaceTimes {
        let summary = Summary::from_values(&self.times);
        let (mean, error) = summary.map_or((0.0, None), |it| (it.mean, it.half_width));
        RaceTimes {
            baseline: self.planned.plan.baseline,
            runs: self.times.len() as u64,
            stopped: self.stopped,
            mean,
            error: error.unwrap_or_default(),
        }
    }

    /// Returns the time that the objective minimizes.
    fn value(&self, objective: Objective) -> f64 {
        match objective {
            Objective::Mean => self.race_times().mean,
            Objective::P90 => quantile(&self.times, 0.9).unwrap_or(f64::INFINITY),
        }
    }
}
