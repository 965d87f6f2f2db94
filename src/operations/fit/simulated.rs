//! Simulated times at the points of a fit.
use std::collections::BTreeMap;

use stochc_experiments::OutcomeCounts;
use stochc_experiments::fit::{Measurement, Simulated};
use stochc_experiments::statistics::{Observation, Status};

use super::run_times::run_times;
use super::{FitProgram, FitSetup, Points};
use crate::exit::Failure;
use crate::host::Host;
use crate::operations::in_memory::all_runs;

/// Simulated times of a measurement at a point.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    /// All times.
    pub times: Simulated,
    /// Number of incomplete times that the fit cannot use.
    pub lost: usize,
    /// Number of simulated runs or waits.
    all: usize,
    /// Number of runs with each outcome. For a capture, aborted attempts at phases count as timed
    /// out.
    pub ends: OutcomeCounts,
}

impl Sample {
    /// Returns whether many times are lost. The known times are then biased towards short ones.
    pub fn is_biased(&self) -> bool {
        self.lost * 10 > self.all
    }

    /// Returns the times as if no incomplete time would ever complete.
    pub fn with_lost(&self) -> Simulated {
        let mut times = self.times.clone();
        for it in &mut times.incomplete {
            it.status = Status::Competing;
        }
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
    let times = run_times(&results.finished, manifest.programs.len())?;
    let count = points.design.points.len();
    let mut found = Vec::new();
    for (i, FitProgram { measurements, .. }) in measured.iter().enumerate() {
        let mut of_program: Vec<Vec<Sample>> = vec![Vec::new(); measurements.len()];
        for (point, at) in points.design.points.iter().enumerate() {
            let entry = i * count + point;
            let program = &manifest.programs[entry];
            let unit = setup.ticks(&program.scene);
            let known = &times[entry];
            let waits: BTreeMap<_, _> = known.waits.times(program).into_iter().collect();
            for (measurement, found) in measurements.iter().zip(&mut of_program) {
                let mut ends = known.outcomes;
                let (all, observed) = match measurement.capture() {
                    None => (setup.runs as usize, &*known.completion),
                    Some(capture) => {
                        ends.timed_out += known.aborts;
                        let waits = waits.get(capture).map_or(&[][..], |it| it);
                        (waits.len(), waits)
                    }
                };
                let times = times_at(at, observed, unit);
                found.push(Sample {
                    lost: lost(&times, all, measurement.horizon()),
                    times,
                    all,
                    ends,
                });
            }
        }
        found.extend(of_program);
    }
    Ok(found)
}

/// Returns simulated times at a point. There are `unit` ticks per unit of the data.
fn times_at(at: &[f64], observed: &[Observation], unit: f64) -> Simulated {
    let completed = observed.iter().filter_map(|it| it.completed_time());
    let incomplete = observed.iter().filter(|it| !it.is_completed());
    Simulated {
        at: at.to_vec(),
        times: completed.map(|ticks| ticks / unit).collect(),
        incomplete: incomplete
            .map(|it| Observation {
                time: it.time / unit,
                ..*it
            })
            .collect(),
    }
}

/// Returns the number of incomplete times that the fit cannot use. `all` is the number of simulated
/// runs or waits. With a horizon, a time is lost if it was censored before the horizon and too few
/// others lasted longer.
fn lost(times: &Simulated, all: usize, horizon: Option<f64>) -> usize {
    match horizon {
        None => all - times.times.len(),
        Some(horizon) if times.is_followed(horizon) => 0,
        Some(horizon) => {
            let incomplete = times.incomplete.iter();
            incomplete.filter(|it| it.at_risk_until() < horizon).count()
        }
    }
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
