//! Estimates with bootstrap intervals, and elasticities.
//!
//! *Resampled values* are the value of a statistic for all runs, and then for each [bootstrap
//! sample](crate::resampling). A value is NaN if the statistic does not exist.
use serde::Serialize;

use crate::resampling::SAMPLES;
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

impl Estimate {
    /// Creates an estimate from resampled values. Returns `None` if the statistic does not exist for
    /// all runs, or for a tenth of the bootstrap samples.
    pub(crate) fn from_resampled(values: &[f64]) -> Option<Estimate> {
        let (&value, samples) = values.split_first()?;
        let samples = samples.iter().copied().filter(|it| it.is_finite());
        let samples: Vec<f64> = samples.collect();
        let is_enough = value.is_finite() && samples.len() * 10 > SAMPLES * 9;
        is_enough.then_some(Estimate {
            value,
            low: quantile(&samples, 0.025)?,
            high: quantile(&samples, 0.975)?,
        })
    }
}

/// Points that differ only in one parameter. Each is the logarithm of the parameter, with resampled
/// values of a statistic.
pub type ElasticityRow<'a> = Vec<(f64, &'a [f64])>;

/// Estimates the elasticity of a statistic: its relative change, divided by the relative change of a
/// parameter.
///
/// The elasticity is the common slope of all rows, by least squares of logarithms. Runs with the
/// same number have common random numbers at all points.
///
/// Returns `None` if no row has different parameters, or the statistic is 0 at a point.
pub fn elasticity(rows: &[ElasticityRow<'_>]) -> Option<Estimate> {
    let slope = |sample: usize| {
        let (mut product, mut square) = (0.0, 0.0);
        for row in rows {
            let middle = row.iter().map(|(log, _)| log).sum::<f64>() / row.len() as f64;
            for (log, values) in row {
                // The ratio to the first value makes the slope of equal values exactly 0.
                product += (log - middle) * (values[sample] / row[0].1[sample]).ln();
                square += (log - middle).powi(2);
            }
        }
        product / square
    };
    Estimate::from_resampled(&(0..=SAMPLES).map(slope).collect::<Vec<f64>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::resampling::{Replicates, weights};
    use stochc_runtime::counter_rng::{Draws, Stream, unit};

    /// Returns resampled sums of the times of a power law at one point. All points have the same
    /// random numbers, except for a share of `own`.
    fn point(seed: u64, parameter: f64, exponent: f64, own: f64) -> (f64, Vec<f64>) {
        let mut sum = Replicates::default();
        for run in 0..40 {
            let draw =
                |seed, key| unit(Draws::new(seed, run, Stream::Shuffle).step(key).block(0)[0]);
            let common = -draw(seed, 0).ln();
            let other = -draw(seed, parameter.to_bits() % 1_000_003 + 1).ln();
            let time = 500.0 * parameter.powf(exponent) * ((1.0 - own) * common + own * other);
            sum.add(time, &weights(seed, run));
        }
        (parameter.ln(), sum.values())
    }

    fn estimate(rows: &[Vec<(f64, Vec<f64>)>]) -> Option<Estimate> {
        let mut borrowed = Vec::new();
        for row in rows {
            let points = row.iter().map(|(log, values)| (*log, &**values));
            borrowed.push(points.collect());
        }
        elasticity(&borrowed)
    }

    #[test]
    fn common_random_numbers_make_an_elasticity_exact() {
        let row = |factor: f64| {
            let points = [1.0, 2.0, 5.0].map(|it| point(3, it, -1.5, 0.0));
            let scaled = points.map(|(log, values)| {
                (log, values.iter().map(|it| it * factor).collect::<Vec<_>>())
            });
            scaled.to_vec()
        };
        // Rows can differ by any factor.
        let found = estimate(&[row(1.0), row(7.0)]).unwrap();
        for value in [found.value, found.low, found.high] {
            assert!((value + 1.5).abs() < 1e-9, "{found:?}");
        }
    }

    /// Checks that the interval contains the exponent with about its nominal probability.
    #[test]
    fn intervals_contain_the_exponent() {
        let ensembles = 300;
        let contains = |seed: &u64| {
            let row = [1.0, 1.5, 2.0, 3.0].map(|it| point(*seed, it, 0.7, 0.5));
            let found = estimate(&[row.to_vec()]).unwrap();
            assert!(found.low < found.value && found.value < found.high);
            (found.low..=found.high).contains(&0.7)
        };
        let inside = (0..ensembles).filter(contains).count();
        // Three standard deviations below 92 %, which is usual for percentile intervals of 40 runs.
        let share = inside as f64 / ensembles as f64;
        assert!((0.87..=0.99).contains(&share), "{share}");
    }

    #[test]
    fn equal_parameters_and_zeros_have_no_elasticity() {
        let one = || point(1, 2.0, 1.0, 0.0);
        assert_eq!(estimate(&[vec![one()], vec![one()]]), None);
        assert_eq!(estimate(&[]), None);
        let never = (3f64.ln(), vec![0.0; SAMPLES + 1]);
        assert_eq!(estimate(&[vec![one(), never]]), None);
    }
}
