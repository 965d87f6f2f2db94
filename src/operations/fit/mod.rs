//! Fits of scene parameters to measured completion times or waiting times.
mod early_ends;
mod run_times;
mod simulated;

use std::path::Path;

use stochc_compiler::LintLevels;
use stochc_experiments::fit::{
    DataError, Design, Emulator, Fit, FittedProgram, MeasuredTimes, Measurement, Observed,
    Posterior, Prior, Unit,
};
use stochc_experiments::statistics::Observation;
use stochc_experiments::sweep::{Parameter, RangeError};
use stochc_files::budget::TIMES;
use stochc_files::read_file;
use stochc_ir::scene::Scene;
use stochc_ir::scene::describe::terms;
use stochc_ir::scene::scalars::find;
use stochc_results::{CpuForecast, EnsembleProgram, Manifest};
use stochc_runtime::Settings;
use stochc_text::number;

use super::forecast::cpu_time;
use super::results::read;
use super::sweep::{at_point, share_tables};
use crate::exit::{Exit, Failure};
use crate::host::Host;

use run_times::run_times;
use simulated::{Sample, check_captures, simulated};

/// Program of a fit, with its measured times.
#[derive(Clone, Debug)]
pub struct FitProgram {
    /// Program. Its scene has the parameter values of the source.
    pub program: EnsembleProgram,
    /// Measured times of the program or of each of its captures, or the number of runs to predict.
    pub measurements: Vec<Measurement>,
}

/// Programs whose times the fit does not use.
#[derive(Clone, Copy, Debug)]
pub struct Unused<'a> {
    /// Names of programs that are held out: their measured times validate the fit.
    pub held_out: &'a [String],
    /// Names of programs without measured times. Their times are only predicted.
    pub predicted: &'a [String],
    /// Assumed number of measured times of a predicted program.
    pub n: usize,
}

/// Options of a fit.
#[derive(Clone, Debug)]
pub struct FitSetup<'a> {
    /// Scene parameters to fit, with their ranges.
    pub priors: &'a [Prior],
    /// Number of points per round. `None` means three per coefficient of the polynomials.
    pub points: Option<usize>,
    /// Number of rounds, at least one. Each round samples the range that is plausible after the
    /// previous round.
    pub rounds: u64,
    /// Number of runs of each program at each point.
    pub runs: u64,
    /// Unit of the measured times.
    pub unit: Unit,
    /// Settings of every simulated run, including the limit of its ticks.
    pub settings: Settings,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Number of threads. `None` means one per core.
    pub threads: Option<u16>,
    /// Levels of warnings.
    pub levels: &'a LintLevels,
}

/// Checks the scene parameters of a fit against the scenes of all programs. Returns the completed
/// priors.
///
/// # Errors
/// If a parameter is given twice or does not exist in a scene. If its range has invalid values or
/// too few values.
pub fn check_priors(
    mut priors: Vec<Prior>,
    measured: &[FitProgram],
) -> Result<Vec<Prior>, Failure> {
    check_twice(&priors)?;
    for FitProgram { program, .. } in measured {
        let for_scene = |prior: Prior| {
            let number = find(&program.scene, &prior.name);
            let number = number.map_err(|error| RangeError::Parameter { error })?;
            prior.for_parameter(Parameter::Scene(number))
        };
        let known: Result<_, RangeError> = priors.into_iter().map(for_scene).collect();
        priors = known.map_err(|error| Failure::usage(format!("--vary: {error}")))?;
        let of_program = |prior: &&Prior| program.parameters.contains_key(&prior.name);
        if let Some(prior) = priors.iter().find(of_program) {
            return Err(Failure::usage(format!(
                "--vary: `{}` is a parameter of `{}`, and a fit varies only scenes",
                prior.name, program.name
            )));
        }
    }
    Ok(priors)
}

/// Checks that no parameter is given twice.
///
/// # Errors
/// If a parameter is given twice.
pub(super) fn check_twice(priors: &[Prior]) -> Result<(), Failure> {
    for (i, prior) in priors.iter().enumerate() {
        if priors[..i].iter().any(|other| other.name == prior.name) {
            let twice = format!("--vary: `{}` is given twice", prior.name);
            return Err(Failure::usage(twice));
        }
    }
    Ok(())
}

/// Reads the measured times of each program from a CSV file or a results folder. Warns if many times
/// in a file are equal, which suggests stopped runs.
///
/// # Errors
/// If the file cannot be read or is not a table of times, or the folder has too few runs.
pub fn measured_times(path: &Path, host: &dyn Host) -> Result<MeasuredTimes, Failure> {
    if path.is_dir() {
        return times_in_folder(path, host);
    }
    let shown = path.display();
    let bytes = read_file(path, TIMES)
        .map_err(|error| Failure::usage(format!("cannot read {shown}: {error}")))?;
    let times = MeasuredTimes::read(&bytes)
        .map_err(|error| Failure::usage(format!("`{shown}`: {error}")))?;
    for pile_up in &times.pile_ups {
        host.warn(&format!("warning: `{shown}`: {pile_up}\n"));
    }
    Ok(times)
}

/// Returns the waiting times of each capture in a results folder, in seconds. An aggregate has no
/// captures, so it has the completion times of its runs.
fn times_in_folder(folder: &Path, host: &dyn Host) -> Result<MeasuredTimes, Failure> {
    let (manifest, finished) = read(folder, host)?;
    let times = run_times(&finished, manifest.programs.len())?;
    let mut programs = Vec::new();
    for (program, known) in manifest.programs.iter().zip(times) {
        let in_seconds = |mut times: Vec<Observation>| {
            times
                .iter_mut()
                .for_each(|it| it.time *= program.scene.tick);
            times
        };
        let observed: Vec<Observed> = if program.tables().aggregate.is_some() {
            let runs = in_seconds(known.completion);
            Observed::from_runs(&runs).into_iter().collect()
        } else {
            let waits = known.waits.times(program).into_iter();
            let waits: Vec<_> = waits.map(|(of, times)| (of, in_seconds(times))).collect();
            Observed::from_captures(&waits)
        };
        if observed.is_empty() {
            return Err(Failure::usage(DataError::TooFew(program.name.clone())));
        }
        programs.extend(observed.into_iter().map(|it| (program.name.clone(), it)));
    }
    Ok(MeasuredTimes {
        unit: Unit::Seconds,
        programs,
        pile_ups: Vec::new(),
    })
}

/// Matches programs with measured times by name.
///
/// # Errors
/// If a program has neither times nor a prediction, times belong to no program, or the fit would
/// use no program.
pub fn matched(
    programs: Vec<EnsembleProgram>,
    mut observed: Vec<(String, Observed)>,
    unused: Unused<'_>,
) -> Result<Vec<FitProgram>, Failure> {
    let mut known: Vec<FitProgram> = Vec::new();
    for program in programs {
        let name = &program.name;
        if known.iter().any(|it| it.program.name == *name) {
            return Err(Failure::usage(format!(
                "two programs are called `{name}`, and times have a name only; leave one of their files out, or rename one"
            )));
        }
        if program.sources.is_empty() {
            return Err(Failure::usage(format!(
                "`{name}` is already compiled; name its source file instead"
            )));
        }
        let own = observed.extract_if(.., |(of, _)| of == name);
        let measurements = measurements(name, own.map(|(_, it)| it).collect(), unused)?;
        known.push(FitProgram {
            program,
            measurements,
        });
    }
    if let Some((left, _)) = observed.first() {
        return Err(Failure::usage(format!(
            "the data have times of `{left}`, and no file declares it"
        )));
    }
    for (option, names) in [
        ("--hold-out", unused.held_out),
        ("--predict", unused.predicted),
    ] {
        let is_known = |name: &String| known.iter().any(|it| it.program.name == *name);
        if let Some(name) = names.iter().find(|name| !is_known(name)) {
            return Err(Failure::usage(format!(
                "{option}: no file declares `{name}`"
            )));
        }
    }
    if all(&known).any(|it| it.is_fitted) {
        Ok(known)
    } else {
        Err(Failure::usage("--hold-out: no program is left to fit to"))
    }
}

/// Returns the measurements of all programs in order.
fn all(measured: &[FitProgram]) -> impl Iterator<Item = &Measurement> {
    measured.iter().flat_map(|it| &it.measurements)
}

fn measurements(
    name: &String,
    observed: Vec<Observed>,
    unused: Unused<'_>,
) -> Result<Vec<Measurement>, Failure> {
    let measurement = |observed: Option<Observed>| Measurement {
        program: name.clone(),
        n: observed.as_ref().map_or(unused.n, |it| it.n),
        is_fitted: observed.is_some() && !unused.held_out.contains(name),
        observed,
    };
    match (observed.is_empty(), unused.predicted.contains(name)) {
        (false, true) => Err(Failure::usage(format!(
            "--predict: the data have times of `{name}`; write `--hold-out {name}`"
        ))),
        (true, false) => Err(Failure::usage(format!(
            "the data have no times of `{name}`; give its times, leave it out of the files, or write `--predict {name}`"
        ))),
        (true, true) => Ok(vec![measurement(None)]),
        (false, false) => Ok(observed.into_iter().map(Some).map(measurement).collect()),
    }
}

/// Points that one round of a fit simulates.
struct Points<'a> {
    design: &'a Design,
    seed: u64,
}

impl FitSetup<'_> {
    /// Returns the number of points per round.
    ///
    /// # Errors
    /// If the points are too few for the polynomials.
    fn points(&self) -> Result<usize, Failure> {
        let numbers = self.priors.len();
        let least = Emulator::terms(numbers) + 2;
        let points = self.points.unwrap_or(3 * Emulator::terms(numbers));
        if points < least {
            Err(Failure::usage(format!(
                "--points: {numbers} numbers need {least} points at least"
            )))
        } else {
            Ok(points)
        }
    }

    fn seed_of_round(&self, round: u64) -> u64 {
        self.seed.wrapping_add(1_000_000 * round)
    }

    /// Returns the points of a round, moved to valid values of the parameters.
    fn design(&self, ends: &[(f64, f64)], round: u64) -> Result<Design, Failure> {
        let mut design = Design::latin_hypercube(ends, self.points()?, self.seed_of_round(round));
        for point in &mut design.points {
            let pairs = point.iter_mut().zip(self.priors);
            pairs.for_each(|(share, prior)| *share = prior.possible(*share));
        }
        Ok(design)
    }

    /// Returns the number of ticks per unit of the measured times.
    fn ticks(&self, scene: &Scene) -> f64 {
        match self.unit {
            Unit::Ticks => 1.0,
            Unit::Seconds => 1.0 / scene.tick,
        }
    }

    /// Returns the manifest of the runs in a round.
    fn manifest(
        &self,
        measured: &[FitProgram],
        points: &Points<'_>,
        host: &dyn Host,
    ) -> Result<Manifest, Failure> {
        let entries = at_points(self, measured, points.design, host)?;
        let settings = self.settings.clone();
        Ok(Manifest::new(settings, points.seed, self.runs, entries))
    }
}

/// Forecasts the CPU time of a fit. Assumes that all rounds take as long as the first one.
///
/// # Errors
/// See [`fit`].
pub fn forecast(
    setup: &FitSetup,
    measured: &[FitProgram],
    host: &dyn Host,
) -> Result<CpuForecast, Failure> {
    let design = setup.design(&vec![(0.0, 1.0); setup.priors.len()], 0)?;
    let points = Points {
        design: &design,
        seed: setup.seed,
    };
    let of_round = cpu_time(&setup.manifest(measured, &points, host)?, host)?;
    Ok(CpuForecast {
        runs: of_round.runs * setup.rounds,
        time: of_round.time * setup.rounds as u32,
        ..of_round
    })
}

/// Simulates all programs at the points of each round and fits the parameters.
///
/// # Errors
/// If there are too few points, runs do not complete at most points, or the user interrupts.
pub fn fit(setup: &FitSetup, measured: &[FitProgram], host: &dyn Host) -> Result<Fit, Failure> {
    let priors = setup.priors;
    check_limit(setup, measured)?;
    let mut ends = vec![(0.0, 1.0); priors.len()];
    let measurements: Vec<&Measurement> = all(measured).collect();
    let mut known: Vec<Vec<Sample>> = vec![Vec::new(); measurements.len()];
    let (mut posterior, mut left_out) = (None, Vec::new());
    for round in 0..setup.rounds {
        let points = Points {
            design: &setup.design(&ends, round)?,
            seed: setup.seed_of_round(round),
        };
        let new = simulated(setup, measured, &points, host)?;
        for (known, new) in known.iter_mut().zip(new) {
            known.extend(new);
        }
        check_captures(&measurements, &known)?;
        let emulators: Vec<_> = (measurements.iter().zip(&known))
            .map(|(measurement, samples)| emulator(measurement, samples, &ends))
            .collect();
        let mut fitted: Vec<FittedProgram> = Vec::new();
        left_out.clear();
        for (measurement, emulator) in measurements.iter().zip(&emulators) {
            match emulator {
                Ok(emulator) => fitted.push(FittedProgram {
                    measurement,
                    emulator,
                }),
                Err(reason) => {
                    let reason = format!("`{}`: {reason}", measurement.label());
                    if measurement.capture().is_none() {
                        return Err(Failure::error(Exit::UnsuccessfulRun, reason));
                    }
                    left_out.push((measurement.is_fitted, reason));
                }
            }
        }
        if !fitted.iter().any(|it| it.measurement.is_fitted) {
            let reason = left_out.iter().find(|(is_fitted, _)| *is_fitted);
            let (_, reason) = reason.expect("a fit has a program to fit to");
            return Err(Failure::error(Exit::UnsuccessfulRun, reason));
        }
        let found = Posterior::new(&ends, &fitted, points.seed);
        let surroundings = found.surroundings().into_iter().zip(priors);
        ends = surroundings
            .map(|(ends, prior)| prior.surroundings(ends))
            .collect();
        let predictions = fitted.iter().map(|it| found.predict(it)).collect();
        posterior = Some((found, predictions));
    }
    let (posterior, predictions): (Posterior, Vec<_>) =
        posterior.expect("there is one round at least");
    for (_, capture) in left_out {
        host.note(&format!("note: left out {capture}\n"));
    }
    let marginals = priors.iter().enumerate();
    let points = setup.points()? * setup.rounds as usize;
    let unused = measurements.iter().zip(&known).flat_map(|(of, samples)| {
        // With a horizon, a few lost times count as long as the horizon.
        let unused = samples
            .iter()
            .filter(|it| of.horizon().is_none() || it.is_biased());
        unused.map(|it| it.lost)
    });
    Ok(Fit {
        unit: setup.unit,
        numbers: marginals
            .map(|(i, prior)| posterior.marginal(i, prior))
            .collect(),
        correlations: posterior.correlations(),
        predictions,
        points,
        runs: points * measured.len() * setup.runs as usize,
        stopped: unused.sum(),
        draws: posterior.values(priors),
    })
}

/// Fits polynomials to the times of a measurement at the points within `ends`. Distant points would
/// distort them.
///
/// # Errors
/// The reason why the times cannot be used.
fn emulator(
    measurement: &Measurement,
    samples: &[Sample],
    ends: &[(f64, f64)],
) -> Result<Emulator, String> {
    let near = || samples.iter().filter(|it| it.times.is_within(ends));
    let new = |points: Vec<_>| Emulator::new(&points, measurement.horizon());
    let unbiased = near().filter(|it| !it.is_biased());
    if let Some(emulator) = new(unbiased.map(|it| it.times.clone()).collect()) {
        return Ok(emulator);
    }
    if measurement.capture().is_some() && new(near().map(Sample::with_lost).collect()).is_none() {
        return Err("it has too few simulated waiting times; raise `--runs`".to_owned());
    }
    Err(match early_ends::reason(near().map(|it| &it.ends)) {
        Some(reason) => format!("too many simulated runs end early: {reason}"),
        None => {
            "too few points have different times; widen the ranges, or raise `--runs`".to_owned()
        }
    })
}

/// Checks that the limit of ticks allows simulated runs to last as long as the measured ones.
fn check_limit(setup: &FitSetup, measured: &[FitProgram]) -> Result<(), Failure> {
    let limit = setup.settings.max_ticks.unwrap_or(u64::MAX);
    for FitProgram {
        program,
        measurements,
    } in measured
    {
        let horizons = measurements.iter().filter_map(Measurement::horizon);
        let horizon = horizons.fold(0.0, f64::max) * setup.ticks(&program.scene);
        if horizon > limit as f64 {
            return Err(Failure::usage(format!(
                "--max-ticks: runs of `{}` were observed for {horizon:.0} ticks; simulate them as long",
                program.name
            )));
        }
    }
    Ok(())
}

/// Returns the scenes of all programs with the fitted medians, as source text that programs can
/// import.
///
/// # Errors
/// If a scene cannot have these values.
pub fn fitted_scenes(
    setup: &FitSetup,
    measured: &[FitProgram],
    fit: &Fit,
    host: &dyn Host,
) -> Result<String, Failure> {
    let mut text = "// Written by `stochc fit`: medians, and 95 % intervals.\n".to_owned();
    for it in &fit.numbers {
        let [median, low, high] = [it.median, it.interval.0, it.interval.1].map(number);
        let line = format!("// {}: {median} ({low} .. {high}) {}", it.name, it.unit);
        text += &format!("{}\n", line.trim_end());
    }
    let mut scenes: Vec<Scene> = Vec::new();
    for FitProgram { program, .. } in measured {
        let mut entry = program.clone();
        let medians = setup.priors.iter().zip(&fit.numbers);
        let varied: Result<_, RangeError> = medians
            .map(|(prior, it)| {
                let parameter = Parameter::find(program, &prior.name)?;
                prior.varied_to(it.median, parameter)
            })
            .collect();
        entry.varied = varied.map_err(Failure::usage)?;
        at_point(&mut entry, setup.levels, host)?;
        if !scenes.contains(&entry.scene) {
            scenes.push(entry.scene);
        }
    }
    for (i, scene) in scenes.iter().enumerate() {
        let is_taken = scenes[..i].iter().any(|other| other.name == scene.name);
        let suffix = if is_taken {
            format!("_{}", i + 1)
        } else {
            String::new()
        };
        text += &format!("scene {}_fitted{suffix} {{\n", scene.name);
        for term in terms(scene) {
            text += &format!("{}\n", term.text);
        }
        text += "}\n";
    }
    let laid_out = stochc_grammar::format(&text);
    Ok(laid_out.expect("clauses are written as they are read"))
}

/// Returns all combinations of programs and points, sorted by program.
fn at_points(
    setup: &FitSetup,
    measured: &[FitProgram],
    design: &Design,
    host: &dyn Host,
) -> Result<Vec<EnsembleProgram>, Failure> {
    let mut entries = Vec::new();
    for FitProgram { program, .. } in measured {
        let at = entries_at(setup.priors, setup.levels, program, &design.points, host);
        entries.extend(at?);
    }
    share_tables(&mut entries);
    Ok(entries)
}

/// Returns a program at each of the points. A point has a coordinate for each prior.
///
/// # Errors
/// If a program cannot run at a point.
pub(super) fn entries_at(
    priors: &[Prior],
    levels: &LintLevels,
    program: &EnsembleProgram,
    points: &[Vec<f64>],
    host: &dyn Host,
) -> Result<Vec<EnsembleProgram>, Failure> {
    let entries = points.iter().map(|point| {
        let mut entry = program.clone();
        let pairs = priors.iter().zip(point);
        let varied: Result<_, RangeError> = pairs
            .map(|(prior, share)| prior.varied(*share, Parameter::find(program, &prior.name)?))
            .collect();
        entry.varied = varied.map_err(Failure::usage)?;
        entry.name += &entry.point();
        at_point(&mut entry, levels, host)?;
        Ok(entry)
    });
    entries.collect()
}
