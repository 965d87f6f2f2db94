//! Simulated times at the points of a fit.
use std::collections::BTreeMap;

use stochc_experiments::fit::{Measurement, Simulated};
use stochc_experiments::statistics::{Observation, Status};
use stochc_experiments::{WaitsTally, completion_time};

use super::{FitProgram, FitSetup, Points};
use crate::exit::Failure;
use crate::host::Host;
use crate::operations::in_memory::all_runs;

/// Simulated times of a measurement at a point.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    /// All times, except the lost ones.
    pub times: Simulated,
    /// Number of times that the fit cannot use because their runs were stopped.
    pub lost: usize,
    /// Number of simulated runs or waits.
    all: usize,
}

impl Sample {
    /// Returns whether many times are lost. The known times are then biased towards short ones.
    pub fn is_biased(&self) -> bool {
        self.lost * 10 > self.all
    }

    /// Returns the times. Lost times count as incomplete.
    pub fn with_lost(&self) -> Simulated {
        let mut times = self.times.clone();
        times.incomplete += self.lost;
        times
    }
}

/// Simulates every program at every point. Returns the times for each measurement.
pub(super) fn simulated(
    setup: &FitSetup,
    measured: &[FitProgram],
    points: &Points<'_>,
    host: &dyn Host,
) -> Result<Vec<Vec<Sample>>, Failure> {
    let manifest = setup.manifest(measured, points, host)?;
    let results = all_runs(&manifest, setup.threads, "nothing was fitted", host)?;
    let mut runs = vec![Vec::new(); manifest.programs.len()];
    let mut waits = vec![WaitsTally::default(); manifest.programs.len()];
    let read = results.finished.each(|done| {
        runs[done.program].extend(completion_time(&done.record));
        waits[done.program].add(&done.record);
    });
    read.map_err(Failure::usage)?;
    let count = points.design.points.len();
    let mut found = Vec::new();
    for (i, FitProgram { measurements, .. }) in measured.iter().enumerate() {
        let mut of_program: Vec<Vec<Sample>> = vec![Vec::new(); measurements.len()];
        for (point, at) in points.design.points.iter().enumerate() {
            let entry = i * count + point;
            let program = &manifest.programs[entry];
            let unit = setup.ticks(&program.scene);
            let waits: BTreeMap<_, _> = waits[entry].times(program).into_iter().collect();
            for (measurement, found) in measurements.iter().zip(&mut of_program) {
                let (all, observed) = match measurement.capture() {
                    None => (setup.runs as usize, &*runs[entry]),
                    Some(capture) => {
                        let waits = waits.get(capture).map_or(&[][..], |it| it);
                        (waits.len(), waits)
                    }
                };
                found.push(simulated_at(at, measurement, (all, observed), unit));
            }
        }
        found.extend(of_program);
    }
    Ok(found)
}

/// Returns the times of a measurement at a point. `all` is the number of simulated runs or waits;
/// `observed` excludes failed ones. There are `unit` ticks per unit of the data.
fn simulated_at(
    at: &[f64],
    measurement: &Measurement,
    (all, observed): (usize, &[Observation]),
    unit: f64,
) -> Sample {
    let completed = observed.iter().filter_map(|it| it.completed_time());
    let times: Vec<f64> = completed.map(|ticks| ticks / unit).collect();
    // After the horizon, an incomplete time is as informative as a complete one.
    let lost = match measurement.horizon() {
        Some(horizon) => censored_before(horizon * unit, observed),
        None => all - times.len(),
    };
    let times = Simulated {
        at: at.to_vec(),
        incomplete: observed.len().saturating_sub(times.len() + lost),
        times,
    };
    Sample { times, lost, all }
}

/// Returns the number of times that were right-censored before the horizon \[ticks\].
fn censored_before(horizon: f64, observed: &[Observation]) -> usize {
    let censored = observed.iter().filter(|it| it.status == Status::Censored);
    // All times are whole ticks.
    censored.filter(|it| it.time + 0.5 < horizon).count()
}

/// Checks that simulated runs contain the measured captures. `found` contains the samples of each
/// measurement.
pub(super) fn check_captures(
    measurements: &[&Measurement],
    found: &[Vec<Sample>],
) -> Result<(), Failure> {
    for (measurement, samples) in measurements.iter().zip(found) {
        let is_missing = samples.iter().all(|it| it.all == 0);
        if let Some(capture) = measurement.capture().filter(|_| is_missing) {
            return Err(Failure::usage(format!(
                "no simulated run of `{}` has the measured capture `{capture}`; fit the program of the measured runs, change \
                 the ranges, or raise `--runs`",
                measurement.program
            )));
        }
    }
    Ok(())
}
