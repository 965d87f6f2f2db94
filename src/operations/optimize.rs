//! Optimization of parameters of programs and scenes.
use std::path::Path;

use stochc_compiler::LintLevels;
use stochc_experiments::fit::{Design, Emulator, Prior, Simulated};
use stochc_experiments::optimize::{
    BestSimulated, ConfirmedConstraint, Constraint, Goal, Objective, OptimalNumber, Optimum,
    PredictedOptimum, estimate, resampled,
};
use stochc_experiments::sweep::{Parameter, RangeError};
use stochc_experiments::{Estimate, completion_time, elasticity};
use stochc_report::figures::Figures;
use stochc_results::{CpuForecast, EnsembleProgram, Finished, Interval, Manifest, Records, Resume};
use stochc_runtime::rates::Rates;
use stochc_runtime::{Model, Settings};

use super::ensemble::{EnsembleOptions, make};
use super::fit::{check_twice, entries_at};
use super::forecast::cpu_time;
use super::in_memory::stopped;
use super::rates::{MissingRates, rates_from};
use super::sweep::share_tables;
use crate::exit::{Exit, Failure};
use crate::host::Host;

/// Number of runs at a point. The emulator needs at least three.
const RUNS: u64 = 4;

/// Largest number of rounds.
const MAX_ROUNDS: u64 = 3;

/// Step of a parameter in the estimate of its elasticity, as a fraction of its value.
const STEP: f64 = 0.1;

/// Options of an optimization.
#[derive(Clone, Debug)]
pub struct OptimizeSetup<'a> {
    /// Parameters to vary, with their ranges.
    pub priors: &'a [Prior],
    /// Quantity to minimize, and its constraints.
    pub goal: Goal<'a>,
    /// Largest number of runs of each program that search for the optimum.
    pub runs: u64,
    /// Number of runs at the optimum, and at each point that an elasticity needs.
    pub confirm: u64,
    /// Settings of every run, without rates. They limit the ticks of a run.
    pub settings: Settings,
    /// Known rates of scenes.
    pub rates: &'a [Rates],
    /// Seed of all random numbers.
    pub seed: u64,
    /// Number of threads. `None` means one per core.
    pub threads: Option<u16>,
    /// Levels of warnings.
    pub levels: &'a LintLevels,
    /// Folder for the runs. Existing runs in it are used again. `None` if they stay in memory.
    pub out: Option<&'a Path>,
}

/// Program during the search.
struct Searched<'a> {
    program: &'a EnsembleProgram,
    priors: Vec<Prior>,
    /// Box of the next round.
    ends: Vec<(f64, f64)>,
    points: Vec<Simulated>,
    found: Option<PredictedOptimum>,
    stopped: usize,
}

/// A program, its parameters, and points with one value of each parameter.
type PointsOfProgram<'a> = (&'a EnsembleProgram, &'a [Prior], Vec<Vec<f64>>);

impl OptimizeSetup<'_> {
    /// Returns the number of rounds, and the number of points in each of them.
    ///
    /// # Errors
    /// If the number of runs is too small for the polynomials.
    fn plan(&self) -> Result<(u64, usize), Failure> {
        let terms = Emulator::terms(self.priors.len());
        let least = (terms + 2).max(3 * terms / 2) as u64;
        let points = |rounds: &u64| self.runs / (RUNS * rounds);
        let rounds = (1..=MAX_ROUNDS).rev().find(|it| points(it) >= least);
        let rounds = rounds.ok_or_else(|| {
            Failure::usage(format!(
                "--runs: {} parameters need at least {} runs",
                self.priors.len(),
                least * RUNS
            ))
        })?;
        Ok((rounds, points(&rounds) as usize))
    }

    fn seed_of(&self, round: u64) -> u64 {
        self.seed.wrapping_add(1_000_000 * round)
    }

    /// Returns the limit of the ticks of a run.
    fn limit(&self) -> f64 {
        self.settings.max_ticks.unwrap_or(u64::MAX) as f64
    }

    /// Returns the manifest of the runs at points of several programs, without rates.
    fn manifest(
        &self,
        points: &[PointsOfProgram<'_>],
        round: u64,
        runs: u64,
        host: &dyn Host,
    ) -> Result<Manifest, Failure> {
        let mut entries = Vec::new();
        for (program, priors, points) in points {
            entries.extend(entries_at(priors, self.levels, program, points, host)?);
        }
        share_tables(&mut entries);
        let settings = self.settings.clone();
        let manifest = Manifest::new(settings, self.seed_of(round), runs, entries);
        manifest.within_limits().map_err(Failure::usage)?;
        Ok(manifest)
    }

    /// Makes the runs of a manifest in the subfolder `name`, except for those that it contains. Adds
    /// missing rates. Returns the completion times of each point, by the number of the run \[ticks\].
    fn sampled(
        &self,
        mut manifest: Manifest,
        name: &str,
        host: &dyn Host,
    ) -> Result<Vec<Vec<f64>>, Failure> {
        if manifest.settings.model == Model::Rate {
            let missing = MissingRates::Calibration(self.threads);
            manifest.settings.rates = rates_from(missing, self.rates, &manifest.programs, host)?;
        }
        let out = self.out.map(|out| out.join(name));
        let is_there = out.as_ref().is_some_and(|out| out.exists());
        let how = EnsembleOptions {
            out: out.as_deref(),
            resume: Resume::from(is_there),
            record: None,
            record_every: 1,
            checkpoints: Interval::DEFAULT,
            threads: self.threads,
            has_warned_of_build: false,
            continues: true,
            measures_cpu: false,
            figures: &Figures::default(),
            watch: false,
            time_limit: None,
        };
        let results = make(&manifest, &how, host)?.results;
        if !results.complete {
            return Err(stopped(match self.out {
                Some(_) => "finished runs are kept. Run the same command to continue",
                None => "nothing was optimized; with `--out DIR`, finished runs are kept",
            }));
        }
        self.times(&manifest, &results.finished)
    }

    /// Returns the times of all runs. The time of an incomplete run is the limit of ticks.
    fn times(&self, manifest: &Manifest, finished: &Records) -> Result<Vec<Vec<f64>>, Failure> {
        let mut times = vec![vec![self.limit(); manifest.runs as usize]; manifest.programs.len()];
        let add = |done: &Finished| {
            let observed = completion_time(&done.record);
            if let Some(time) = observed.and_then(|it| it.completed_time()) {
                times[done.program][done.record.run as usize] = time;
            }
        };
        finished.each(add).map_err(Failure::usage)?;
        Ok(times)
    }
}

/// Searches for the optimum of each program, and confirms it.
///
/// # Errors
/// If a parameter cannot be varied, or there are too few runs or points. If the user interrupts.
pub fn optimize(
    setup: &OptimizeSetup<'_>,
    programs: &[EnsembleProgram],
    host: &dyn Host,
) -> Result<Vec<Optimum>, Failure> {
    let (rounds, number) = setup.plan()?;
    let mut searched = started(setup, programs)?;
    for round in 0..rounds {
        let designs = searched.iter().map(|it| design(setup, it, number, round));
        let designs: Vec<Vec<Vec<f64>>> = designs.collect();
        let points = searched.iter().zip(&designs);
        let points: Vec<_> = points
            .map(|(it, design)| (it.program, &*it.priors, design.clone()))
            .collect();
        let manifest = setup.manifest(&points, round, RUNS, host)?;
        let name = format!("round-{}", round + 1);
        let sampled = setup.sampled(manifest, &name, host)?;
        let mut times = sampled.iter();
        for (it, design) in searched.iter_mut().zip(designs) {
            for (at, times) in design.into_iter().zip(&mut times) {
                let (times, stopped) = spread(times, setup.limit());
                it.stopped += stopped;
                it.points.push(Simulated {
                    at,
                    times,
                    incomplete: Vec::new(),
                });
            }
            let common = (RUNS * (round + 1)) as f64;
            let found = PredictedOptimum::new(
                &it.points,
                &it.ends,
                &it.priors,
                setup.goal,
                common,
                setup.seed_of(round),
            );
            let found = found.ok_or_else(|| {
                Failure::error(
                    Exit::UnsuccessfulRun,
                    "too few points have different times: widen the ranges, or raise `--runs` or `--max-ticks`",
                )
            })?;
            it.ends = found.surroundings(&it.priors);
            it.found = Some(found);
        }
    }
    confirmed(setup, searched, rounds, host)
}

/// Forecasts the CPU time of an optimization, without calibrations. Assumes that all points take as
/// long as those of the first round.
///
/// # Errors
/// See [`optimize`].
pub fn forecast(
    setup: &OptimizeSetup<'_>,
    programs: &[EnsembleProgram],
    host: &dyn Host,
) -> Result<CpuForecast, Failure> {
    let (rounds, number) = setup.plan()?;
    let searched = started(setup, programs)?;
    let points = searched
        .iter()
        .map(|it| (it.program, &*it.priors, design(setup, it, number, 0)));
    let mut manifest = setup.manifest(&points.collect::<Vec<_>>(), 0, RUNS, host)?;
    if manifest.settings.model == Model::Rate {
        manifest.settings.rates =
            rates_from(MissingRates::Default, setup.rates, &manifest.programs, host)?;
    }
    let of_round = cpu_time(&manifest, host)?;
    let confirming = (1 + 2 * setup.priors.len()) as u64 * setup.confirm * programs.len() as u64;
    let runs = of_round.runs * rounds + confirming;
    Ok(CpuForecast {
        runs,
        time: of_round
            .time
            .mul_f64(runs as f64 / of_round.runs.max(1) as f64),
        ..of_round
    })
}

/// Checks the parameters and returns the programs at the start of the search.
fn started<'a>(
    setup: &OptimizeSetup<'_>,
    programs: &'a [EnsembleProgram],
) -> Result<Vec<Searched<'a>>, Failure> {
    check_twice(setup.priors)?;
    if let Some(tick) = setup.priors.iter().find(|prior| prior.name == "tick") {
        let name = &tick.name;
        return Err(Failure::usage(format!(
            "--vary: `{name}` is the unit of all times and cannot be optimized"
        )));
    }
    let too_long = |option: &str| {
        let message = format!("{option}: the time must be shorter than `--max-ticks`");
        Err(Failure::usage(message))
    };
    if let Objective::Exceeds(time) = setup.goal.objective
        && time >= setup.limit()
    {
        return too_long("--minimize");
    }
    let mut constraints = setup.goal.constraints.iter();
    if constraints.any(|it| it.time() >= setup.limit()) {
        return too_long("--subject-to");
    }
    let each = programs.iter().map(|program| {
        if program.sources.is_empty() {
            return Err(Failure::usage(format!(
                "--vary: `{}` is already compiled; name its source file instead",
                program.name
            )));
        }
        let priors = setup.priors.iter().cloned();
        let priors: Result<Vec<Prior>, RangeError> = priors
            .map(|prior| {
                let name = prior.name.clone();
                let parameter = Parameter::find(program, &name)?;
                if program.set.iter().any(|it| it.name == parameter.name()) {
                    return Err(RangeError::AxisIsSet(name.clone()));
                }
                prior.for_parameter(parameter)
            })
            .collect();
        Ok(Searched {
            program,
            priors: priors.map_err(|error| Failure::usage(format!("--vary: {error}")))?,
            ends: vec![(0.0, 1.0); setup.priors.len()],
            points: Vec::new(),
            found: None,
            stopped: 0,
        })
    });
    each.collect()
}

/// Returns the points of a round, with valid values and each only once.
fn design(
    setup: &OptimizeSetup<'_>,
    it: &Searched<'_>,
    number: usize,
    round: u64,
) -> Vec<Vec<f64>> {
    let mut points: Vec<Vec<f64>> = Vec::new();
    // Whole numbers have few values, so a design can contain equal points.
    for more in [1, 4, 16] {
        let design = Design::latin_hypercube(&it.ends, more * number, setup.seed_of(round));
        for point in design.points {
            let pairs = point.iter().zip(&it.priors);
            let point: Vec<f64> = pairs.map(|(share, prior)| prior.possible(*share)).collect();
            if points.len() < number && !points.contains(&point) {
                points.push(point);
            }
        }
    }
    points
}

/// Multiplies the times of stopped runs by 1, 2, 3 and so on, because the emulator needs different
/// times. Also returns the number of these runs.
fn spread(times: &[f64], limit: f64) -> (Vec<f64>, usize) {
    let mut stopped = 0;
    let times = times.iter().map(|&time| {
        let is_stopped = time >= limit;
        stopped += usize::from(is_stopped);
        time * if is_stopped { stopped as f64 } else { 1.0 }
    });
    (times.collect(), stopped)
}

/// Simulates the optima and their neighbours with another seed.
fn confirmed(
    setup: &OptimizeSetup<'_>,
    searched: Vec<Searched<'_>>,
    rounds: u64,
    host: &dyn Host,
) -> Result<Vec<Optimum>, Failure> {
    let (points, neighbours): (Vec<_>, Vec<_>) = searched.iter().map(neighbourhood).unzip();
    let points = searched.iter().zip(points);
    let points: Vec<_> = points
        .map(|(it, points)| (it.program, &*it.priors, points))
        .collect();
    let manifest = setup.manifest(&points, rounds, setup.confirm, host)?;
    let sampled = setup.sampled(manifest, "confirmation", host)?;
    let mut times = sampled.iter();
    let mut optima = Vec::new();
    for ((it, neighbours), (_, _, points)) in searched.iter().zip(neighbours).zip(&points) {
        let times: Vec<&Vec<f64>> = times.by_ref().take(points.len()).collect();
        let limit = setup.limit();
        let stopped = times.iter().flat_map(|times| times.iter());
        let stopped = stopped.filter(|time| **time >= limit).count();
        let numbers = it.priors.iter().zip(neighbours).enumerate();
        let numbers = numbers.map(|(i, (prior, [low, high]))| {
            let pair = [low, high].map(|near| {
                let values = resampled(setup.goal.objective, times[near.point], setup.seed);
                (prior.value(near.share).ln(), values)
            });
            let row = pair.iter().map(|(log, values)| (*log, &**values));
            OptimalNumber {
                value: prior.rounded(it.optimum()[i]),
                similar: it.found().similar.marginal(i, prior),
                elasticity: elasticity(&[row.collect()]),
            }
        });
        let constraints = setup.goal.constraints.iter().zip(&it.found().constraints);
        let confirm = |(constraint, predicted): (&Constraint, &Estimate)| ConfirmedConstraint {
            constraint: constraint.name(),
            predicted: *predicted,
            confirmed: estimate(constraint.objective, times[0], setup.seed),
            verdict: constraint.verdict(times[0], limit, setup.seed),
        };
        optima.push(Optimum {
            program: it.program.name.clone(),
            objective: setup.goal.objective.name(),
            numbers: numbers.collect(),
            predicted: it.found().value,
            confirmed: estimate(setup.goal.objective, times[0], setup.seed),
            constraints: constraints.map(confirm).collect(),
            feasible: it.found().is_feasible,
            best_simulated: BestSimulated::new(&it.points, &it.priors, setup.goal.objective),
            points: it.points.len(),
            runs: it.points.len() * RUNS as usize,
            confirming: setup.confirm,
            stopped: it.stopped,
            stopped_confirming: stopped,
        });
    }
    Ok(optima)
}

impl Searched<'_> {
    fn found(&self) -> &PredictedOptimum {
        self.found.as_ref().expect("there is one round at least")
    }

    fn optimum(&self) -> &[f64] {
        &self.found().at
    }
}

/// Point that differs from the optimum in one parameter.
struct Neighbour {
    /// Coordinate of the parameter.
    share: f64,
    /// Index of the point among those that are simulated.
    point: usize,
}

/// Returns the points to simulate: the optimum and its neighbours. Each parameter has a neighbour
/// with a smaller value and one with a larger value.
fn neighbourhood(it: &Searched<'_>) -> (Vec<Vec<f64>>, Vec<[Neighbour; 2]>) {
    let at = it.optimum();
    let mut points = vec![at.to_vec()];
    let pairs = at.iter().zip(&it.priors).enumerate();
    let near = pairs.map(|(i, (share, prior))| {
        let value = prior.value(*share);
        let step = if prior.is_whole {
            (STEP * value.abs()).round().max(1.0)
        } else {
            STEP * value.abs()
        };
        [value - step, value + step].map(|value| {
            let share = prior.possible(prior.share(value));
            // At an end of a range, the optimum is its own neighbour.
            if share == at[i] {
                return Neighbour { share, point: 0 };
            }
            let mut moved = at.to_vec();
            moved[i] = share;
            points.push(moved);
            Neighbour {
                share,
                point: points.len() - 1,
            }
        })
    });
    let near = near.collect();
    (points, near)
}
