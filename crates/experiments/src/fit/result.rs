//! Result of a fit.
use serde::Serialize;

use super::data::Unit;
use super::emulator::Emulator;
use super::observed::Observed;
use super::posterior::{Marginal, Posterior};
use super::prior::Prior;
use crate::statistics::quantile;

/// Result of fitting scene parameters to measured times.
#[derive(Clone, Debug, Serialize)]
pub struct Fit {
    /// Unit of all times.
    pub unit: Unit,
    /// Marginal posterior of each parameter, in the order of the priors.
    pub numbers: Vec<Marginal>,
    /// Correlation of each pair of parameters in the posterior.
    pub correlations: Vec<Vec<f64>>,
    /// Prediction for each program.
    pub predictions: Vec<Prediction>,
    /// Number of points that were simulated in all rounds.
    pub points: usize,
    /// Number of runs at all these points.
    pub runs: usize,
    /// Number of incomplete simulated times that the fit cannot use. A run has a completion time, or
    /// the waiting times of its captures.
    pub stopped: usize,
    /// Draws from the posterior, in the units of the priors. Each is a list of values.
    pub draws: Vec<Vec<f64>>,
}

/// Data of a program in a fit: measured times, or a number of runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Measurement {
    /// Name of the program.
    pub program: String,
    /// Number of times: measured times, or runs to predict.
    pub n: usize,
    /// Measured times. `None` if the program is only predicted.
    pub observed: Option<Observed>,
    /// Whether the parameters are fitted to the program. `false` if it was held out or has no data.
    pub is_fitted: bool,
}

impl Measurement {
    /// Returns the name of the capture that was measured. `None` for completion times.
    pub fn capture(&self) -> Option<&str> {
        self.observed.as_ref()?.capture.as_deref()
    }

    /// Returns the name of the program, and of the capture if there is one.
    pub fn label(&self) -> String {
        match self.capture() {
            None => self.program.clone(),
            Some(capture) => format!("{}, {capture}", self.program),
        }
    }

    /// Returns the horizon, in the unit of the table. Longer times are replaced by the horizon.
    /// Returns `None` if all times are used unchanged.
    pub fn horizon(&self) -> Option<f64> {
        self.observed.as_ref()?.horizon
    }

    /// Returns the effective number of runs, which accounts for early censoring.
    fn effective_n(&self) -> f64 {
        let observed = self.observed.as_ref();
        observed.map_or(self.n as f64, |it| it.effective_n)
    }
}

/// Predicted value of a statistic with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Median of the prediction.
    pub median: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
}

impl Interval {
    /// Returns whether a value is within the interval.
    pub fn has(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    fn from_values(values: &[f64]) -> Interval {
        let at = |share| quantile(values, share).unwrap_or(f64::NAN);
        Interval {
            median: at(0.5),
            low: at(0.025),
            high: at(0.975),
        }
    }

    fn map(self, to: impl Fn(f64) -> f64) -> Interval {
        Interval {
            median: to(self.median),
            low: to(self.low),
            high: to(self.high),
        }
    }
}

/// Posterior prediction of a program's times for a new measurement of the same size.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Prediction {
    /// Data of the program.
    #[serde(flatten)]
    pub measurement: Measurement,
    /// Mean of the times. Each time is limited by the horizon.
    pub mean: Interval,
    /// Standard deviation. `None` if there is a horizon.
    pub sd: Option<Interval>,
    /// Fraction of times that are longer than the horizon. `None` without a horizon.
    pub incomplete: Option<Interval>,
}

impl Prediction {
    /// Returns whether the measured mean is within its predicted interval.
    pub fn has_mean(&self) -> bool {
        let observed = self.measurement.observed.as_ref();
        observed.is_none_or(|observed| self.mean.has(observed.mean))
    }

    /// Returns whether the measured standard deviation is within its predicted interval.
    pub fn has_sd(&self) -> bool {
        let pair = self.measurement.observed.as_ref().zip(self.sd);
        pair.is_none_or(|(observed, sd)| sd.has(observed.sd))
    }

    /// Returns whether the measured fraction of incomplete runs is within its predicted interval.
    pub fn has_incomplete(&self) -> bool {
        let pair = self.measurement.observed.as_ref().zip(self.incomplete);
        pair.is_none_or(|(observed, incomplete)| incomplete.has(observed.incomplete))
    }
}

/// Program of a fit, with its emulator.
pub struct FittedProgram<'a> {
    /// Data of the program.
    pub measurement: &'a Measurement,
    /// Emulator of the program's simulated times.
    pub emulator: &'a Emulator,
}

impl Observed {
    /// Returns the measured values of the statistics that an emulator predicts.
    fn statistics(&self) -> Vec<f64> {
        match self.horizon {
            None => vec![self.mean.ln(), self.sd.ln()],
            Some(horizon) => {
                let square = self.second_moment() / (horizon * horizon);
                vec![self.mean / horizon, square, self.incomplete]
            }
        }
    }
}

impl Posterior {
    /// Returns the posterior of the parameters, given the data of the fitted programs. `ends` is
    /// the box that the emulators were fitted in. Outside of this box, the posterior is zero.
    pub fn new(ends: &[(f64, f64)], programs: &[FittedProgram], seed: u64) -> Posterior {
        let fitted = programs.iter().filter(|it| it.measurement.is_fitted);
        let likelihoods: Vec<_> = fitted
            .filter_map(|it| {
                let observed = it.measurement.observed.as_ref()?;
                let (statistics, n) = (observed.statistics(), observed.effective_n);
                Some(it.emulator.log_likelihood(statistics, n))
            })
            .collect();
        let likelihood = |at: &[f64]| likelihoods.iter().map(|of| of(at)).sum();
        Posterior::sample(ends, likelihood, seed)
    }

    /// Returns the prediction for another measurement of the program with the same number of runs.
    pub fn predict(&self, program: &FittedProgram) -> Prediction {
        let measurement = program.measurement;
        let chance = program
            .emulator
            .sampling_variances(measurement.effective_n());
        let interval = |which: usize| {
            let draws = self.draws.iter().enumerate();
            let values: Vec<f64> = draws
                .map(|(i, draw)| {
                    let estimate = program.emulator.estimate(draw);
                    let sd = (estimate.variance[which] + chance[which]).sqrt();
                    // The errors are at evenly spread quantiles, from a deterministic sequence.
                    let share = (i as f64 * 0.618_033_988_749_894_9 + 0.5).fract();
                    estimate.values[which] + sd * normal_at(share)
                })
                .collect();
            Interval::from_values(&values)
        };
        let (mean, sd, incomplete) = match measurement.horizon() {
            None => (
                interval(0).map(f64::exp),
                Some(interval(1).map(f64::exp)),
                None,
            ),
            Some(horizon) => {
                let part = |it: f64| it.clamp(0.0, 1.0);
                let mean = interval(0).map(|it| horizon * part(it));
                (mean, None, Some(interval(2).map(part)))
            }
        };
        Prediction {
            measurement: measurement.clone(),
            mean,
            sd,
            incomplete,
        }
    }

    /// Returns the correlation of each pair of parameters.
    pub fn correlations(&self) -> Vec<Vec<f64>> {
        let numbers = self.draws.first().map_or(0, Vec::len);
        let n = self.draws.len() as f64;
        let mean = |i: usize| self.draws.iter().map(|draw| draw[i]).sum::<f64>() / n;
        let means: Vec<f64> = (0..numbers).map(mean).collect();
        let product = |i: usize, j: usize| {
            let each = self
                .draws
                .iter()
                .map(|draw| (draw[i] - means[i]) * (draw[j] - means[j]));
            each.sum::<f64>() / n
        };
        let row = |i| {
            let of = |j| product(i, j) / (product(i, i) * product(j, j)).sqrt();
            (0..numbers).map(of).collect()
        };
        (0..numbers).map(row).collect()
    }

    /// Returns the draws in the units of the priors.
    pub fn values(&self, priors: &[Prior]) -> Vec<Vec<f64>> {
        let value = |draw: &Vec<f64>| {
            let pairs = draw.iter().zip(priors);
            pairs.map(|(share, prior)| prior.value(*share)).collect()
        };
        self.draws.iter().map(value).collect()
    }
}

fn normal_at(share: f64) -> f64 {
    use statrs::distribution::{ContinuousCDF as _, Normal};
    Normal::standard().inverse_cdf(share.clamp(1e-9, 1.0 - 1e-9))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::super::{Design, Simulated};
    use super::*;
    use crate::statistics::Observation;

    /// Returns simulated times: sums of four waiting times whose mean is a function of two
    /// parameters.
    fn times(random: &mut ChaCha8Rng, at: &[f64], n: usize) -> Vec<f64> {
        let mean = (6.0 - 1.2 * at[0] + 0.4 * at[1] * at[0]).exp();
        let wait = |random: &mut ChaCha8Rng| -(1.0 - random.random::<f64>()).ln() * mean / 4.0;
        (0..n).map(|_| (0..4).map(|_| wait(random)).sum()).collect()
    }

    /// Returns the result of two rounds of a fit. `simulated` returns times at a point, for each
    /// measurement.
    fn two_rounds(
        measurements: &[Measurement],
        mut simulated: impl FnMut(&[f64]) -> Vec<Vec<Observation>>,
        seed: u64,
    ) -> (Marginal, Prediction) {
        let mut ends = vec![(0.0, 1.0); 2];
        let mut points: Vec<Vec<Simulated>> = vec![Vec::new(); measurements.len()];
        let mut found = None;
        for round in 0..2 {
            let design = Design::latin_hypercube(&ends, 18, seed + 1000 * round);
            for at in design.points {
                for (points, times) in points.iter_mut().zip(simulated(&at)) {
                    let (completed, incomplete): (Vec<_>, Vec<_>) =
                        times.into_iter().partition(|it| it.is_completed());
                    points.push(Simulated {
                        times: completed.iter().map(|it| it.time).collect(),
                        at: at.clone(),
                        incomplete,
                    });
                }
            }
            let emulators = points
                .iter()
                .zip(measurements)
                .map(|(points, measurement)| {
                    let horizon = measurement.horizon();
                    let is_known = |it: &&Simulated| horizon.is_none_or(|end| it.is_followed(end));
                    let near = points.iter().filter(|point| point.is_within(&ends));
                    let near: Vec<Simulated> = near.filter(is_known).cloned().collect();
                    Emulator::new(&near, horizon)
                });
            let emulators: Vec<Option<Emulator>> = emulators.collect();
            let pairs = measurements.iter().zip(&emulators);
            // Captures with too few waiting times are left out.
            let measured: Vec<FittedProgram> = pairs
                .filter_map(|(measurement, emulator)| {
                    let emulator = emulator.as_ref()?;
                    Some(FittedProgram {
                        measurement,
                        emulator,
                    })
                })
                .collect();
            let posterior = Posterior::new(&ends, &measured, seed);
            ends = posterior.surroundings();
            let prior = Prior::parse("x=0..1").unwrap();
            let prediction = posterior.predict(&measured[0]);
            found = Some((posterior.marginal(0, &prior), prediction));
        }
        found.unwrap()
    }

    fn measurement(observed: Observed) -> Measurement {
        Measurement {
            program: "sums".to_owned(),
            n: observed.n,
            observed: Some(observed),
            is_fitted: true,
        }
    }

    /// Returns the fit of the first parameter to completion times. The times are measured at
    /// `truth`; run `i` is censored at `limit(i)`.
    fn fitted(
        random: &mut ChaCha8Rng,
        truth: &[f64],
        limit: impl Fn(usize) -> f64,
        seed: u64,
    ) -> (Marginal, Prediction) {
        let times_of_truth = times(random, truth, 100);
        let runs = times_of_truth.iter().enumerate();
        let runs: Vec<Observation> = runs
            .map(|(i, &time)| {
                if time > limit(i) {
                    Observation::censored(limit(i))
                } else {
                    Observation::completed(time)
                }
            })
            .collect();
        let measurement = measurement(Observed::from_runs(&runs).unwrap());
        let simulated = |at: &[f64]| {
            let times = times(random, at, 12).into_iter();
            vec![times.map(Observation::completed).collect()]
        };
        two_rounds(&[measurement], simulated, seed)
    }

    /// Returns the waiting times of three captures, one after the other, in `n` runs. They have
    /// different means. Each run is stopped at `limit`.
    fn waits(random: &mut ChaCha8Rng, at: &[f64], n: usize, limit: f64) -> Vec<Vec<Observation>> {
        let mut left = vec![limit; n];
        let shares = [0.2, 1.0, 1.8].into_iter();
        let waits = shares.map(|share| {
            let waits = times(random, at, n).into_iter().zip(&mut left);
            let waits = waits.filter(|(_, left)| **left > 0.0);
            waits
                .map(|(wait, left)| {
                    let wait = share * wait / 3.0;
                    let end = std::mem::replace(left, *left - wait);
                    if wait > end {
                        Observation::censored(end)
                    } else {
                        Observation::completed(wait)
                    }
                })
                .collect()
        });
        waits.collect()
    }

    /// Returns the fit of the first parameter to the waiting times of three captures. The waiting
    /// times are measured at `truth`. Measured and simulated runs are stopped at `limit`.
    fn fitted_to_waits(
        random: &mut ChaCha8Rng,
        truth: &[f64],
        limit: f64,
        seed: u64,
    ) -> (Marginal, Prediction) {
        let captures = waits(random, truth, 100, limit).into_iter();
        let captures: Vec<_> = captures.map(|it| ("wait".to_owned(), it)).collect();
        let observed = Observed::from_captures(&captures).into_iter();
        let measurements: Vec<Measurement> = observed.map(measurement).collect();
        assert_eq!(measurements.len(), 3);
        two_rounds(&measurements, |at| waits(random, at, 24, limit), seed)
    }

    /// Checks the coverage of the 95 % intervals of fits. The arguments of `fitted` are a random
    /// generator, the truth and a seed. Returns the intervals' mean width.
    fn check_coverage(
        fitted: impl Fn(&mut ChaCha8Rng, &[f64], u64) -> (Marginal, Prediction),
    ) -> f64 {
        const TRIALS: u64 = 60;
        let (mut held, mut widths) = (0, 0.0);
        for trial in 0..TRIALS {
            let mut random = ChaCha8Rng::seed_from_u64(trial);
            let truth = [0.2 + 0.6 * random.random::<f64>(), 0.5];
            let (low, high) = fitted(&mut random, &truth, trial).0.interval;
            held += u64::from((low..=high).contains(&truth[0]));
            widths += high - low;
        }
        let width = widths / TRIALS as f64;
        println!("{held} of {TRIALS}, mean width {width}");
        // By the binomial distribution, at most 52 of 60 intervals contain the truth with a
        // probability of 1 %.
        assert!(held >= 52, "{held} of {TRIALS}");
        width
    }

    /// Checks the coverage if run `i` of a measurement is censored at `limit(i)`. The mean time is
    /// 221 at the centre of the range. Returns the intervals' mean width.
    fn check_coverage_of_runs(limit: impl Fn(usize) -> f64) -> f64 {
        check_coverage(|random, truth, seed| fitted(random, truth, &limit, seed))
    }

    #[test]
    fn intervals_have_their_coverage() {
        let width = check_coverage_of_runs(|_| f64::INFINITY);
        assert!(width < 0.5, "the data say something");
    }

    /// Checks the coverage of intervals if runs are stopped. In the first three cases, half of the
    /// runs, three quarters, or a few runs at different times are stopped. In the last case, half
    /// of the runs are stopped early.
    #[test]
    fn intervals_have_their_coverage_with_censoring() {
        let early = |i: usize| match i % 10 {
            0 => 20.0 * (1 + i / 10) as f64,
            _ => f64::INFINITY,
        };
        let halves = |i: usize| if i.is_multiple_of(2) { 140.0 } else { 280.0 };
        let widths = [
            check_coverage_of_runs(|_| 220.0),
            check_coverage_of_runs(|_| 150.0),
            check_coverage_of_runs(early),
            check_coverage_of_runs(halves),
        ];
        // The data constrain the parameter: without data, the width would be 0.95.
        assert!(
            widths.iter().all(|width| *width < 0.75 * 0.95),
            "{widths:?}"
        );
    }

    /// Checks the coverage of fits to waiting times. In the second case, half of the runs are
    /// stopped, and in the third case most of them.
    #[test]
    fn intervals_from_waiting_times_have_their_coverage() {
        for limit in [f64::INFINITY, 220.0, 100.0] {
            let width =
                check_coverage(|random, truth, seed| fitted_to_waits(random, truth, limit, seed));
            assert!(width < 0.75 * 0.95, "{limit}: {width}");
        }
    }

    /// Checks a prior range that does not contain the truth. The prediction then misses the data.
    /// The posterior is usually at the end of the range that is nearest to the truth.
    #[test]
    fn reports_a_true_value_beyond_the_range() {
        let mut at_end = 0;
        for trial in 0..20 {
            let beyond = [2.5, -1.5][trial as usize % 2];
            let mut random = ChaCha8Rng::seed_from_u64(100 + trial);
            let truth = [beyond, 0.5];
            let (found, predicted) = fitted(&mut random, &truth, |_| f64::INFINITY, trial);
            assert!(!predicted.has_mean(), "{trial}: {predicted:?}");
            let end = f64::from(beyond > 0.0);
            at_end += u32::from(found.is_at_edge && (found.median - end).abs() < 0.1);
        }
        println!("{at_end} of 20");
        assert!(at_end >= 15, "{at_end} of 20");
    }
}
