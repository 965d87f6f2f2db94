//! Emulator: statistics of a program's times as functions of scene parameters.
use nalgebra::{DMatrix, DVector};

use super::simulated::Simulated;
use super::statistics::TimeStatistics;

/// Prediction of an [`Emulator`] at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct EmulatorPrediction {
    /// Predicted statistics in the order of `TimeStatistics`.
    pub values: Vec<f64>,
    /// Variance of the emulator's error for each statistic.
    pub variance: Vec<f64>,
}

/// Emulator: a quadratic polynomial in the parameters for each statistic, fitted by least squares.
#[derive(Clone, Debug)]
pub struct Emulator {
    /// Centre and half-width of the range of points, by direction.
    scale: Vec<(f64, f64)>,
    polynomials: Vec<Polynomial>,
    /// Matrix (XᵀX)⁻¹ of the least-squares fit.
    inverse: DMatrix<f64>,
    /// Mean leverage (xᵀ (XᵀX)⁻¹ x) over the points of the design.
    mean_leverage: f64,
    /// Covariance of the statistics of one run. For n runs, it is divided by n.
    unit_covariance: DMatrix<f64>,
}

#[derive(Clone, Debug)]
struct Polynomial {
    coefficients: DVector<f64>,
    /// Variance of the residuals.
    residual: f64,
    /// Part of the residual variance that the scatter of the runs does not explain.
    lack_of_fit: f64,
}

impl Emulator {
    /// Returns the number of coefficients of a polynomial in `numbers` parameters.
    pub fn terms(numbers: usize) -> usize {
        1 + 2 * numbers + numbers * numbers.saturating_sub(1) / 2
    }

    /// Fits polynomials to the statistics of simulated points. Times are limited by `horizon`.
    ///
    /// Returns `None` if the points are collinear or too few: at least two more than
    /// [`Emulator::terms`] are needed.
    pub fn new(points: &[Simulated], horizon: Option<f64>) -> Option<Emulator> {
        let numbers = points.first()?.at.len();
        let known: Vec<(&Simulated, TimeStatistics)> = (points.iter())
            .filter_map(|point| Some((point, TimeStatistics::new(point, horizon)?)))
            .collect();
        let terms = Emulator::terms(numbers);
        if known.len() < terms + 2 {
            return None;
        }
        let scale: Vec<(f64, f64)> = (0..numbers)
            .map(|i| {
                let ends = known.iter().map(|(point, _)| point.at[i]);
                let (low, high) = ends
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
                        (low.min(x), high.max(x))
                    });
                ((low + high) / 2.0, ((high - low) / 2.0).max(1e-9))
            })
            .collect();
        let rows = known.iter().map(|(point, _)| features(&point.at, &scale));
        let rows: Vec<f64> = rows.flatten().collect();
        let matrix = DMatrix::from_row_slice(known.len(), terms, &rows);
        let inverse = (matrix.transpose() * &matrix).cholesky()?.inverse();
        let statistics: Vec<TimeStatistics> = known.into_iter().map(|(_, it)| it).collect();
        let count = statistics.first()?.values.len();
        let fit = |which: usize| Polynomial::fit(&statistics, which, &matrix, &inverse);
        let covariances = statistics.iter().map(|it| &it.unit_covariance);
        let sum = covariances.fold(DMatrix::zeros(count, count), |sum, it| sum + it);
        Some(Emulator {
            scale,
            mean_leverage: terms as f64 / statistics.len() as f64,
            polynomials: (0..count).map(fit).collect(),
            inverse,
            unit_covariance: sum / statistics.len() as f64,
        })
    }

    /// Returns the prediction at a point.
    pub fn estimate(&self, at: &[f64]) -> EmulatorPrediction {
        let features = self.features(at);
        let leverage = features.dot(&(&self.inverse * &features));
        EmulatorPrediction {
            values: self.values(&features).collect(),
            variance: self.variances(leverage).collect(),
        }
    }

    /// Returns the predicted statistics at a point, without their errors.
    pub(crate) fn values_at(&self, at: &[f64]) -> Vec<f64> {
        self.values(&self.features(at)).collect()
    }

    /// Returns the terms of the polynomials at a point: 1, x, x² and all products.
    fn features(&self, at: &[f64]) -> DVector<f64> {
        DVector::from_vec(features(at, &self.scale))
    }

    /// Returns the value of each polynomial at a point with these [`Emulator::features`].
    fn values(&self, features: &DVector<f64>) -> impl Iterator<Item = f64> {
        (self.polynomials.iter()).map(|it| it.coefficients.dot(features))
    }

    /// Returns, for each statistic, the variance of the emulator's error at a point with this
    /// leverage.
    fn variances(&self, leverage: f64) -> impl Iterator<Item = f64> {
        (self.polynomials.iter()).map(move |it| it.residual * leverage + it.lack_of_fit)
    }

    /// Returns the logarithm of the likelihood of statistics of `n` runs at a point, up to a
    /// constant.
    ///
    /// Uses the variance averaged over the points of the design. If each point had its own
    /// variance, data that no point explains would seem most likely at the least certain points.
    pub(crate) fn log_likelihood(&self, measured: Vec<f64>, n: f64) -> impl Fn(&[f64]) -> f64 {
        let errors: Vec<f64> = self.variances(self.mean_leverage).collect();
        let errors = DMatrix::from_diagonal(&DVector::from_vec(errors));
        let inverse = (&self.unit_covariance / n + errors).try_inverse();
        let measured = DVector::from_vec(measured);
        move |at| {
            let Some(inverse) = &inverse else {
                return f64::NEG_INFINITY;
            };
            let features = self.features(at);
            let expected = self.values(&features);
            let off = &measured - DVector::from_iterator(measured.len(), expected);
            -0.5 * off.dot(&(inverse * &off))
        }
    }

    pub(crate) fn sampling_variances(&self, n: f64) -> Vec<f64> {
        let diagonal = self.unit_covariance.diagonal();
        diagonal.iter().map(|variance| variance / n).collect()
    }
}

impl Polynomial {
    /// Fits the polynomial of statistic `which`. The rows of `matrix` are the terms at the points,
    /// and `inverse` is its (XᵀX)⁻¹.
    fn fit(
        statistics: &[TimeStatistics],
        which: usize,
        matrix: &DMatrix<f64>,
        inverse: &DMatrix<f64>,
    ) -> Polynomial {
        let points = statistics.len();
        let values = DVector::from_iterator(points, statistics.iter().map(|it| it.values[which]));
        let coefficients = inverse * matrix.transpose() * &values;
        let freedom = (points - matrix.ncols()) as f64;
        let residual = (&values - matrix * &coefficients).norm_squared() / freedom;
        let noise = (statistics.iter()).map(|it| it.unit_covariance[(which, which)] / it.n);
        let noise = noise.sum::<f64>() / points as f64;
        Polynomial {
            coefficients,
            residual,
            lack_of_fit: (residual - noise).max(0.0),
        }
    }
}

/// Returns the terms 1, x, x², and all products of two coordinates.
fn features(at: &[f64], scale: &[(f64, f64)]) -> Vec<f64> {
    let x: Vec<f64> = (at.iter().zip(scale))
        .map(|(at, (middle, half))| (at - middle) / half)
        .collect();
    let mut features = vec![1.0];
    features.extend(&x);
    for i in 0..x.len() {
        features.extend(x[i..].iter().map(|other| x[i] * other));
    }
    features
}

#[cfg(test)]
mod tests {
    use super::super::Design;
    use super::*;

    /// Returns `n` quantiles of a gamma distribution of shape 4, in an order that depends on
    /// `turn`.
    fn times(mean: f64, n: usize, turn: usize) -> Vec<f64> {
        use statrs::distribution::{ContinuousCDF as _, Gamma};
        let gamma = Gamma::new(4.0, 4.0 / mean).unwrap();
        let share = |i: usize| ((i * 7 + turn * 3) % n) as f64;
        (0..n)
            .map(|i| gamma.inverse_cdf((share(i) + 0.5) / n as f64))
            .collect()
    }

    fn points(mean: impl Fn(&[f64]) -> f64) -> Vec<Simulated> {
        let design = Design::latin_hypercube(&[(0.0, 1.0), (0.0, 1.0)], 30, 3);
        let points = design.points.into_iter().enumerate();
        points
            .map(|(turn, at)| Simulated {
                times: times(mean(&at), 24, turn),
                at,
                incomplete: Vec::new(),
            })
            .collect()
    }

    #[test]
    fn recovers_a_quadratic() {
        let law =
            |at: &[f64]| (5.0 + 0.8 * at[0] - 0.3 * at[1] * at[0] + 0.2 * at[1] * at[1]).exp();
        let emulator = Emulator::new(&points(law), None).unwrap();
        for at in [[0.5, 0.5], [0.1, 0.9], [0.0, 0.0]] {
            let found = emulator.estimate(&at).values[0];
            assert!((found - law(&at).ln()).abs() < 0.01, "{at:?}: {found}");
        }
        // The coefficient of variation of a gamma distribution of shape 4 is one half.
        let spread = emulator.estimate(&[0.5, 0.5]);
        assert!((spread.values[1] - spread.values[0] - 0.5f64.ln()).abs() < 0.05);
        // The variance of the logarithm of a mean is CV² / n.
        let of_mean = emulator.sampling_variances(100.0)[0];
        assert!((of_mean * 100.0 / 0.25 - 1.0).abs() < 0.15, "{of_mean}");
    }

    #[test]
    fn the_true_value_has_the_highest_likelihood() {
        let law = |at: &[f64]| (5.0 + 0.8 * at[0]).exp();
        let emulator = Emulator::new(&points(law), None).unwrap();
        let mean = law(&[0.5, 0.0]);
        let likelihood = emulator.log_likelihood(vec![mean.ln(), (mean / 2.0).ln()], 100.0);
        let likelihood = |x| likelihood(&[x, 0.5]);
        assert!(likelihood(0.5) > likelihood(0.3) + 1.0);
        assert!(likelihood(0.5) > likelihood(0.7) + 1.0);
    }

    #[test]
    fn misfit_of_a_quadratic_is_estimated() {
        let rough = |at: &[f64]| (5.0 + 0.5 * (12.0 * at[0]).sin()).exp();
        let smooth = |at: &[f64]| (5.0 + 0.5 * at[0]).exp();
        let error = |emulator: &Emulator| emulator.estimate(&[0.5, 0.5]).variance[0].sqrt();
        let [rough, smooth] = [
            Emulator::new(&points(rough), None),
            Emulator::new(&points(smooth), None),
        ];
        assert!(error(&rough.unwrap()) > 0.2);
        assert!(error(&smooth.unwrap()) < 0.1);
    }

    #[test]
    fn too_few_points_give_no_emulator() {
        let all = points(|_| 100.0);
        assert!(Emulator::new(&all[..7], None).is_none());
        assert!(Emulator::new(&all[..8], None).is_some());
        assert!(Emulator::new(&[], None).is_none());
    }
}
