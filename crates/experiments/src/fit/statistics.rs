//! Statistics for comparing simulated and measured times.
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use super::observed::{cut, effective_n};
use super::simulated::Simulated;
use crate::statistics::KaplanMeier;

/// Statistics of a sample of times, with their covariance.
///
/// Without a horizon, the statistics are the logarithms of mean and standard deviation. With a
/// horizon, they are three means over all runs. The first is of the time as a fraction of the
/// horizon, the second of the square of this fraction. The third is the fraction of incomplete
/// runs. Runs that are censored before the horizon count as in the Kaplan-Meier estimate.
pub struct TimeStatistics {
    /// Values of the two or three statistics.
    pub values: DVector<f64>,
    /// Covariance of the statistics, multiplied by the effective number of runs.
    pub unit_covariance: DMatrix<f64>,
    /// Effective number of runs: number of uncensored runs that would be equally informative.
    pub n: f64,
}

/// Lower bound of the variance of a fraction. Keeps covariances invertible if all runs are
/// censored.
const MIN_VARIANCE: f64 = 1e-8;

impl TimeStatistics {
    /// Returns the statistics of simulated times. Returns `None` for fewer than three times, or if
    /// all times are equal.
    pub fn new(simulated: &Simulated, horizon: Option<f64>) -> Option<TimeStatistics> {
        match horizon {
            None => TimeStatistics::logarithms(&simulated.times),
            Some(horizon) => TimeStatistics::means(simulated, horizon),
        }
    }

    /// Returns the logarithms of mean and standard deviation, with their jackknife covariance.
    fn logarithms(times: &[f64]) -> Option<TimeStatistics> {
        let n = times.len() as f64;
        let (sum, squares) = (
            times.iter().sum::<f64>(),
            times.iter().map(|t| t * t).sum::<f64>(),
        );
        let logarithms = |n: f64, sum: f64, squares: f64| {
            let mean = sum / n;
            let variance = (squares - n * mean * mean) / (n - 1.0);
            let of = Vector2::new(mean.ln(), 0.5 * variance.ln());
            (variance > 1e-12 * mean * mean && of.iter().all(|it| it.is_finite())).then_some(of)
        };
        if times.len() < 3 {
            return None;
        }
        let of = logarithms(n, sum, squares)?;
        let without: Option<Vec<Vector2<f64>>> = (times.iter())
            .map(|time| logarithms(n - 1.0, sum - time, squares - time * time))
            .collect();
        let without = without?;
        let middle = without.iter().sum::<Vector2<f64>>() / n;
        let spread = without
            .iter()
            .map(|it| (it - middle) * (it - middle).transpose());
        // The covariance of the statistics is (n - 1) / n times the sum.
        let unit_covariance = spread.sum::<Matrix2<f64>>() * (n - 1.0);
        Some(TimeStatistics {
            values: DVector::from_column_slice(of.as_slice()),
            unit_covariance: DMatrix::from_column_slice(2, 2, unit_covariance.as_slice()),
            n,
        })
    }

    /// Returns the three means for a horizon, from the Kaplan-Meier curve of the times.
    fn means(simulated: &Simulated, horizon: f64) -> Option<TimeStatistics> {
        let runs = cut(&simulated.all(), horizon);
        if runs.len() < 3 {
            return None;
        }
        let curve = KaplanMeier::new(&runs)?;
        let shares: Vec<(DVector<f64>, f64)> = (curve.shares())
            .map(|(time, share)| {
                let part = (time / horizon).min(1.0);
                let beyond = f64::from(time > horizon);
                (DVector::from_vec(vec![part, part * part, beyond]), share)
            })
            .collect();
        let zero = DVector::zeros(3);
        let mean = (shares.iter()).fold(zero, |sum, (it, share)| sum + it * *share);
        let least = DMatrix::from_diagonal_element(3, 3, MIN_VARIANCE);
        let scatter = (shares.iter()).fold(DMatrix::zeros(3, 3), |sum, (it, share)| {
            sum + (it - &mean) * (it - &mean).transpose() * *share
        });
        let n = runs.len() as f64;
        Some(TimeStatistics {
            n: effective_n(&curve, &runs, horizon),
            values: mean,
            unit_covariance: scatter * (n / (n - 1.0)) + least,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::Observation;

    #[test]
    fn runs_beyond_the_horizon_count_as_incomplete_at_it() {
        let simulated = Simulated {
            at: vec![0.5],
            times: vec![10.0, 30.0, 90.0],
            incomplete: vec![Observation::censored(60.0)],
        };
        let found = TimeStatistics::new(&simulated, Some(40.0)).unwrap();
        let expected = [
            (0.25 + 0.75 + 2.0) / 4.0,
            (0.0625 + 0.5625 + 2.0) / 4.0,
            0.5,
        ];
        for (found, expected) in found.values.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        // The sample has four runs, two of them incomplete.
        let of_share = found.unit_covariance[(2, 2)];
        assert!((of_share - 1.0 / 3.0).abs() < 1e-6 && (found.n - 4.0).abs() < 1e-9);
        let none = Simulated {
            times: vec![],
            incomplete: vec![Observation::censored(60.0); 4],
            ..simulated
        };
        let none = TimeStatistics::new(&none, Some(40.0)).unwrap();
        assert_eq!(none.values.as_slice(), [1.0, 1.0, 1.0]);
        assert!(none.unit_covariance.try_inverse().is_some());
    }

    /// The run that is censored at 20 has the same chances as the two runs that last longer.
    #[test]
    fn runs_censored_before_the_horizon_share_their_weight() {
        let simulated = Simulated {
            at: vec![0.5],
            times: vec![10.0, 30.0],
            incomplete: vec![Observation::censored(20.0), Observation::censored(50.0)],
        };
        let found = TimeStatistics::new(&simulated, Some(40.0)).unwrap();
        let shares = [(0.25, 0.25), (0.75, 0.375), (1.0, 0.375)];
        let expected = [
            shares.iter().map(|(part, share)| part * share).sum(),
            shares.iter().map(|(part, share)| part * part * share).sum(),
            0.375,
        ];
        for (found, expected) in found.values.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        assert!((3.0..4.0).contains(&found.n), "{}", found.n);
    }
}
