//! Estimates from the runs that confirm an optimum.
use serde::Serialize;

use super::Objective;
use crate::resampling::{SAMPLES, weights};
use crate::statistics::quantile;

/// Value with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Estimated value.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

/// Estimates the objective from the times of runs, by bootstrap. Returns `None` without runs.
pub fn estimate(objective: Objective, times: &[f64], seed: u64) -> Option<Estimate> {
    resampled(times.len(), seed, |weights| {
        objective.of_sample(times.iter().copied().zip(weights.iter().copied()))
    })
}

/// Estimates the elasticity of the objective: its relative change, divided by the relative change
/// of a parameter. `times` contains the times of runs at a smaller and at a larger value. Runs with
/// the same index have common random numbers. `log_ratio` is the logarithm of the ratio of both
/// values.
///
/// Returns `None` if the objective is 0 at one of the values.
pub fn elasticity(
    objective: Objective,
    times: [&[f64]; 2],
    log_ratio: f64,
    seed: u64,
) -> Option<Estimate> {
    let runs = times[0].len().min(times[1].len());
    resampled(runs, seed, |weights| {
        let [low, high] = times
            .map(|times| objective.of_sample(times.iter().copied().zip(weights.iter().copied())));
        let change = (high? / low?).ln() / log_ratio;
        change.is_finite().then_some(change)
    })
}

/// Returns a statistic of weighted runs with its bootstrap interval. All runs have weight 1 in the
/// first call of `statistic`. Returns `None` if a tenth of the bootstrap samples has no value.
fn resampled(
    runs: usize,
    seed: u64,
    statistic: impl Fn(&[f64]) -> Option<f64>,
) -> Option<Estimate> {
    let value = statistic(&vec![1.0; runs])?;
    let weights: Vec<_> = (0..runs as u64).map(|run| weights(seed, run)).collect();
    let samples = (0..SAMPLES).filter_map(|sample| {
        let weights = weights.iter().map(|of| f64::from(of[sample]));
        statistic(&weights.collect::<Vec<_>>())
    });
    let samples: Vec<f64> = samples.collect();
    let is_enough = samples.len() * 10 > SAMPLES * 9;
    is_enough.then_some(Estimate {
        value,
        low: quantile(&samples, 0.025)?,
        high: quantile(&samples, 0.975)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns evenly spread quantiles of an exponential distribution, in a fixed random order.
    fn times(mean: f64) -> Vec<f64> {
        let share = |i: usize| ((i * 37 % 101) as f64 + 0.5) / 101.0;
        (0..101).map(|i| -mean * (1.0 - share(i)).ln()).collect()
    }

    #[test]
    fn the_interval_of_a_mean_is_as_wide_as_by_students_t() {
        let times = times(500.0);
        let found = estimate(Objective::Mean, &times, 3).unwrap();
        let expected = crate::statistics::Summary::from_values(&times).unwrap();
        let half = expected.half_width.unwrap();
        assert!((found.value - expected.mean).abs() < 1e-9);
        let ratio = (found.high - found.low) / 2.0 / half;
        assert!((0.75..1.25).contains(&ratio), "{ratio}");
    }

    #[test]
    fn common_random_numbers_make_an_elasticity_exact() {
        // A power law with exponent -1.5.
        let (low, high) = (times(500.0), times(500.0 * 1.2f64.powf(-1.5)));
        for objective in [Objective::Mean, Objective::Quantile(0.9)] {
            let found = elasticity(objective, [&low, &high], 1.2f64.ln(), 3).unwrap();
            for value in [found.value, found.low, found.high] {
                assert!((value + 1.5).abs() < 1e-9, "{objective:?} {value}");
            }
        }
        let never = Objective::Exceeds(1e6);
        assert_eq!(elasticity(never, [&low, &high], 1.2f64.ln(), 3), None);
    }
}
