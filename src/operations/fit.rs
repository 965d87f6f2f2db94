//! Finding numbers of scenes that measured times speak for.
use std::path::Path;

use stochc_compiler::LintLevels;
use stochc_ensemble::fit::{
    Design, Emulator, Fit, FittedProgram, Observed, Posterior, Prior, Simulated, Unit,
};
use stochc_ensemble::statistics::Observation;
use stochc_ensemble::{EnsembleProgram, Manifest, completion_time};
use stochc_files::budget::TIMES;
use stochc_files::read_file;
use stochc_runtime::Settings;

use super::in_memory::all_runs;
use super::sweep::{at_point, share_tables};
use crate::exit::{Exit, Failure};
use crate::host::Host;

/// A program, and what was measured of it; whether that is used.
pub type Known = (EnsembleProgram, (Observed, bool));

/// How a fit is made.
#[derive(Clone, Debug)]
pub struct FitSetup<'a> {
    /// The numbers to find, and where they may be.
    pub priors: &'a [Prior],
    /// Points of each round; `None`: three for each coefficient of the polynomials.
    pub points: Option<usize>,
    /// Each within what the one before has left; one at least.
    pub rounds: u64,
    /// Of each program at each point.
    pub runs: u64,
    /// Of every run; `max_ticks` is where one is stopped.
    pub settings: Settings,
    /// Of all chance.
    pub seed: u64,
    /// Runs at the same time; `None`: as many as there are cores.
    pub threads: Option<u16>,
    /// What becomes of warnings.
    pub levels: &'a LintLevels,
}

/// The numbers to find as those of the scenes of all programs.
///
/// # Errors
/// If one is given twice, is none of a scene, may have no value there that an end of its range is, or only a few.
pub fn of_scenes(mut priors: Vec<Prior>, measured: &[Known]) -> Result<Vec<Prior>, Failure> {
    for (i, prior) in priors.iter().enumerate() {
        if priors[..i].iter().any(|other| other.of == prior.of) {
            let twice = format!("--vary: `{}` is given twice", prior.of);
            return Err(Failure::usage(twice));
        }
    }
    for (program, _) in measured {
        let of_scene = |prior: Prior| prior.of_scene(&program.scene);
        let known: Result<_, String> = priors.into_iter().map(of_scene).collect();
        priors = known.map_err(|told| Failure::usage(format!("--vary: {told}")))?;
    }
    Ok(priors)
}

/// The times of a file (CSV), program by program.
///
/// # Errors
/// If it cannot be read, or is no such file.
pub fn measured_times(path: &Path) -> Result<(Unit, Vec<Observed>), Failure> {
    let shown = path.display();
    let bytes = read_file(path, TIMES)
        .map_err(|error| Failure::usage(format!("cannot read {shown}: {error}")))?;
    Observed::read(&bytes).map_err(|error| Failure::usage(format!("`{shown}`: {error}")))
}

/// Holds names against names: everything that was measured has a program, and the other way round.
///
/// # Errors
/// If one has no other, or none is left to fit to.
pub fn matched(
    programs: Vec<EnsembleProgram>,
    mut observed: Vec<Observed>,
    held_out: &[String],
) -> Result<Vec<Known>, Failure> {
    let mut known: Vec<Known> = Vec::new();
    for program in programs {
        if known.iter().any(|(it, _)| it.name == program.name) {
            return Err(Failure::usage(format!(
                "two programs are called `{}`, and the data cannot tell which they are of; leave one of their files out, or rename one",
                program.name
            )));
        }
        let place = observed.iter().position(|it| it.program == program.name);
        let Some(place) = place else {
            let name = &program.name;
            return Err(Failure::usage(format!(
                "the data say nothing of `{name}`; give its times, or leave it out of the files"
            )));
        };
        if program.sources.is_empty() {
            return Err(Failure::usage(format!(
                "`{}` is compiled already; name the file of its text instead",
                program.name
            )));
        }
        let of = observed.remove(place);
        let is_fitted = !held_out.contains(&of.program);
        known.push((program, (of, is_fitted)));
    }
    if let Some(left) = observed.first() {
        return Err(Failure::usage(format!(
            "the data have times of `{}`, and no file declares it",
            left.program
        )));
    }
    if let Some(name) = held_out
        .iter()
        .find(|&name| known.iter().all(|(it, _)| it.name != *name))
    {
        return Err(Failure::usage(format!(
            "--hold-out: no file declares `{name}`"
        )));
    }
    match known.iter().any(|(_, (_, is_fitted))| *is_fitted) {
        true => Ok(known),
        false => Err(Failure::usage("--hold-out: no program is left to fit to")),
    }
}

/// Simulates at the points of each round, and draws conclusions.
///
/// # Errors
/// If there are too few points, the runs do not complete at most of them, or somebody stops it.
pub fn fit(
    setup: &FitSetup,
    measured: &[Known],
    unit: Unit,
    host: &dyn Host,
) -> Result<Fit, Failure> {
    let priors = setup.priors;
    let numbers = priors.len();
    let least = Emulator::terms(numbers) + 2;
    let points = setup.points.unwrap_or(3 * Emulator::terms(numbers));
    if points < least {
        return Err(Failure::usage(format!(
            "--points: {numbers} numbers need {least} points at least"
        )));
    }
    let mut ends = vec![(0.0, 1.0); numbers];
    let mut all: Vec<Vec<Simulated>> = vec![Vec::new(); measured.len()];
    let (mut posterior, mut stopped) = (None, 0);
    for round in 0..setup.rounds {
        let seed = setup.seed.wrapping_add(1_000_000 * round);
        let mut design = Design::latin_hypercube(&ends, points, seed);
        for point in &mut design.points {
            let pairs = point.iter_mut().zip(priors);
            pairs.for_each(|(share, prior)| *share = prior.possible(*share));
        }
        let (new, lost) = simulated(setup, measured, unit, (&design, seed), host)?;
        stopped += lost;
        for (all, new) in all.iter_mut().zip(new) {
            all.extend(new);
        }
        let emulators: Option<Vec<Emulator>> = (all.iter())
            .map(|points| {
                // Further away, a polynomial would bend for what does not matter any more.
                let near = points.iter().filter(|point| point.is_within(&ends));
                Emulator::of(&near.cloned().collect::<Vec<_>>())
            })
            .collect();
        let Some(emulators) = emulators else {
            return Err(Failure::error(
                Exit::UnsuccessfulRun,
                "at too few points do the runs complete: narrow the ranges, or raise `--max-ticks`",
            ));
        };
        let known = emulators.iter().zip(measured);
        let known: Vec<FittedProgram> = known
            .map(|(emulator, (_, (observed, is_fitted)))| FittedProgram {
                observed,
                is_fitted: *is_fitted,
                emulator,
            })
            .collect();
        let found = Posterior::of(&ends, &known, seed);
        let surroundings = found.surroundings().into_iter().zip(priors);
        ends = surroundings
            .map(|(ends, prior)| prior.surroundings(ends))
            .collect();
        let predictions = known.iter().map(|it| found.predict(it)).collect();
        posterior = Some((found, predictions));
    }
    let (posterior, predictions): (Posterior, Vec<_>) =
        posterior.expect("there is one round at least");
    let marginals = priors.iter().enumerate();
    Ok(Fit {
        unit,
        numbers: marginals
            .map(|(i, prior)| posterior.marginal(i, prior))
            .collect(),
        correlations: posterior.correlations(),
        predictions,
        points: points * setup.rounds as usize,
        runs: points * setup.rounds as usize * measured.len() * setup.runs as usize,
        stopped,
        draws: posterior.values(priors),
    })
}

/// The times of every program at every point of a design, and how many runs were stopped.
fn simulated(
    setup: &FitSetup,
    measured: &[Known],
    unit: Unit,
    (design, seed): (&Design, u64),
    host: &dyn Host,
) -> Result<(Vec<Vec<Simulated>>, usize), Failure> {
    let entries = at_points(setup, measured, design, host)?;
    let manifest = Manifest::new(setup.settings.clone(), seed, setup.runs, entries);
    let points = design.points.len();
    let results = all_runs(&manifest, setup.threads, "nothing was fitted", host)?;
    let mut found: Vec<Vec<Simulated>> = vec![Vec::new(); measured.len()];
    let mut stopped = 0;
    let mut observed = vec![Vec::new(); manifest.programs.len()];
    let read = results.finished.each(|done| {
        let time = completion_time(&done.record).and_then(Observation::completed_time);
        observed[done.program].extend(time);
    });
    read.map_err(Failure::usage)?;
    for (entry, program) in manifest.programs.iter().enumerate() {
        let scale = match unit {
            Unit::Ticks => 1.0,
            Unit::Seconds => program.scene.tick,
        };
        let times: Vec<f64> = observed[entry].iter().map(|time| time * scale).collect();
        stopped += setup.runs as usize - times.len();
        // A point where many runs are stopped has times of the fast ones.
        if times.len() * 10 >= setup.runs as usize * 9 {
            let at = design.points[entry % points].clone();
            found[entry / points].push(Simulated { at, times });
        }
    }
    Ok((found, stopped))
}

/// Each program at each point, the points of the first program first.
fn at_points(
    setup: &FitSetup,
    measured: &[Known],
    design: &Design,
    host: &dyn Host,
) -> Result<Vec<EnsembleProgram>, Failure> {
    let mut entries = Vec::new();
    for (program, _) in measured {
        for point in &design.points {
            let mut entry = program.clone();
            let pairs = setup.priors.iter().zip(point);
            let varied: Result<_, String> = pairs
                .map(|(prior, share)| prior.varied(*share, &program.scene))
                .collect();
            entry.varied = varied.map_err(Failure::usage)?;
            entry.name += &entry.point();
            at_point(&mut entry, setup.levels, host)?;
            entries.push(entry);
        }
    }
    share_tables(&mut entries);
    Ok(entries)
}
