//! Mean and spread of a program's times as functions of the numbers of its scene.
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

/// The times of a program at a point of the design.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulated {
    /// The point: a share of the prior for every number.
    pub at: Vec<f64>,
    /// Times to completion, in the unit of the data; 3 at least.
    pub times: Vec<f64>,
}

impl Simulated {
    /// Whether the point is in a box, given by its lower and upper ends.
    pub fn is_within(&self, ends: &[(f64, f64)]) -> bool {
        is_within(&self.at, ends)
    }
}

/// Whether a point is in a box, given by its lower and upper ends.
pub(super) fn is_within(at: &[f64], ends: &[(f64, f64)]) -> bool {
    let mut sides = at.iter().zip(ends);
    sides.all(|(at, (low, high))| (*low..=*high).contains(at))
}

/// The logarithms of mean and standard deviation of a sample, and how well they are known.
struct Logarithms {
    of: Vector2<f64>,
    /// Covariance of the two, by the jackknife, times the size of the sample.
    unit_covariance: Matrix2<f64>,
    n: f64,
}

/// What an [`Emulator`] says of a point: logarithms of the mean and of the standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmulatorPrediction {
    /// The two.
    pub of: [f64; 2],
    /// Variances of their errors.
    pub variance: [f64; 2],
}

/// Quadratic polynomials in the numbers, by least squares, for the logarithms of mean and standard deviation.
#[derive(Clone, Debug)]
pub struct Emulator {
    /// Middle and half the width of the points, in each direction.
    scale: Vec<(f64, f64)>,
    coefficients: [DVector<f64>; 2],
    /// (XᵀX)⁻¹ of the least squares.
    inverse: DMatrix<f64>,
    /// The leverage of the points on average.
    mean_leverage: f64,
    /// Variance of the residuals.
    residual: [f64; 2],
    /// What of it the polynomials miss, and no number of runs would mend.
    lack_of_fit: [f64; 2],
    /// Covariance of the two logarithms in a sample of one run; that of n runs is an n-th of it.
    unit_covariance: Matrix2<f64>,
}

impl Emulator {
    /// Coefficients of a polynomial in so many numbers.
    pub fn terms(numbers: usize) -> usize {
        1 + 2 * numbers + numbers * numbers.saturating_sub(1) / 2
    }

    /// Fits polynomials to simulated points; `None`: there are too few points (two more than [`Emulator::terms`] are needed), or they
    /// lie in a line.
    pub fn of(points: &[Simulated]) -> Option<Emulator> {
        let numbers = points.first()?.at.len();
        let known: Vec<(&Simulated, Logarithms)> = (points.iter())
            .filter_map(|point| Some((point, Logarithms::of(&point.times)?)))
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
        let freedom = (known.len() - terms) as f64;
        let fit = |which: usize| {
            let values =
                DVector::from_iterator(known.len(), known.iter().map(|(_, it)| it.of[which]));
            let coefficients = &inverse * matrix.transpose() * &values;
            let residual = (&values - &matrix * &coefficients).norm_squared() / freedom;
            let noise = known
                .iter()
                .map(|(_, it)| it.unit_covariance[(which, which)] / it.n);
            let noise = noise.sum::<f64>() / known.len() as f64;
            (coefficients, residual, (residual - noise).max(0.0))
        };
        let [mean, spread] = [0, 1].map(fit);
        let covariances = known.iter().map(|(_, it)| it.unit_covariance);
        Some(Emulator {
            scale,
            mean_leverage: terms as f64 / known.len() as f64,
            residual: [mean.1, spread.1],
            lack_of_fit: [mean.2, spread.2],
            coefficients: [mean.0, spread.0],
            inverse,
            unit_covariance: covariances.sum::<Matrix2<f64>>() / known.len() as f64,
        })
    }

    /// What is to be expected at a point.
    pub fn estimate(&self, at: &[f64]) -> EmulatorPrediction {
        let features = self.features(at);
        let leverage = features.dot(&(&self.inverse * &features));
        EmulatorPrediction {
            of: self.logarithms(&features),
            variance: self.variance(leverage),
        }
    }

    /// The terms of the polynomials at a place.
    fn features(&self, at: &[f64]) -> DVector<f64> {
        DVector::from_vec(features(at, &self.scale))
    }

    /// The values of the polynomials, of these terms.
    fn logarithms(&self, features: &DVector<f64>) -> [f64; 2] {
        [0, 1].map(|which| self.coefficients[which].dot(features))
    }

    /// Variances of the errors where the polynomials have this leverage.
    fn variance(&self, leverage: f64) -> [f64; 2] {
        [0, 1].map(|which| self.residual[which] * leverage + self.lack_of_fit[which])
    }

    /// The logarithm of the likelihood of a mean and a standard deviation of n runs at a point, up to a constant.
    ///
    /// The variance of the polynomials is that of a design's point on average. With that of each place, data that nothing explains
    /// would be likeliest where least is known.
    pub(crate) fn log_likelihood(&self, at: &[f64], n: usize, mean: f64, sd: f64) -> f64 {
        let features = self.features(at);
        let covariance = self.unit_covariance / n as f64
            + Matrix2::from_diagonal(&Vector2::from(self.variance(self.mean_leverage)));
        let off = Vector2::new(mean.ln(), sd.ln()) - Vector2::from(self.logarithms(&features));
        match covariance.try_inverse() {
            Some(inverse) => {
                let squares = (off.transpose() * inverse * off)[(0, 0)];
                -0.5 * (squares + covariance.determinant().ln())
            }
            None => f64::NEG_INFINITY,
        }
    }

    /// Variance of the logarithm of the mean of n runs, by chance alone.
    pub(crate) fn sampling_variance(&self, n: usize) -> [f64; 2] {
        [0, 1].map(|which| self.unit_covariance[(which, which)] / n as f64)
    }
}

/// 1, x, x², and all products of two.
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

impl Logarithms {
    /// `None`: there are fewer than three times, or no spread.
    fn of(times: &[f64]) -> Option<Logarithms> {
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
        Some(Logarithms {
            of,
            // (n - 1) / n times the sum is the covariance of the sample's figures.
            unit_covariance: spread.sum::<Matrix2<f64>>() * (n - 1.0),
            n,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::Design;
    use super::*;

    /// Times that fill a gamma distribution of shape 4 by its quantiles, turned by the number of the point.
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
            })
            .collect()
    }

    #[test]
    fn a_quadratic_is_found_again() {
        let law =
            |at: &[f64]| (5.0 + 0.8 * at[0] - 0.3 * at[1] * at[0] + 0.2 * at[1] * at[1]).exp();
        let emulator = Emulator::of(&points(law)).unwrap();
        for at in [[0.5, 0.5], [0.1, 0.9], [0.0, 0.0]] {
            let found = emulator.estimate(&at).of[0];
            assert!((found - law(&at).ln()).abs() < 0.01, "{at:?}: {found}");
        }
        // Half the coefficient of variation of a gamma distribution of shape 4.
        let spread = emulator.estimate(&[0.5, 0.5]);
        assert!((spread.of[1] - spread.of[0] - 0.5f64.ln()).abs() < 0.05);
        // The variance of the logarithm of a mean is CV² / n.
        let [of_mean, _] = emulator.sampling_variance(100);
        assert!((of_mean * 100.0 / 0.25 - 1.0).abs() < 0.15, "{of_mean}");
    }

    #[test]
    fn the_truth_is_likelier_than_what_is_beside_it() {
        let law = |at: &[f64]| (5.0 + 0.8 * at[0]).exp();
        let emulator = Emulator::of(&points(law)).unwrap();
        let mean = law(&[0.5, 0.0]);
        let likelihood = |x| emulator.log_likelihood(&[x, 0.5], 100, mean, mean / 2.0);
        assert!(likelihood(0.5) > likelihood(0.3) + 1.0);
        assert!(likelihood(0.5) > likelihood(0.7) + 1.0);
    }

    #[test]
    fn what_no_quadratic_can_say_is_known_as_an_error() {
        let rough = |at: &[f64]| (5.0 + 0.5 * (12.0 * at[0]).sin()).exp();
        let smooth = |at: &[f64]| (5.0 + 0.5 * at[0]).exp();
        let error = |emulator: &Emulator| emulator.estimate(&[0.5, 0.5]).variance[0].sqrt();
        let [rough, smooth] = [Emulator::of(&points(rough)), Emulator::of(&points(smooth))];
        assert!(error(&rough.unwrap()) > 0.2);
        assert!(error(&smooth.unwrap()) < 0.1);
    }

    #[test]
    fn too_few_points_say_nothing() {
        let all = points(|_| 100.0);
        assert!(Emulator::of(&all[..7]).is_none());
        assert!(Emulator::of(&all[..8]).is_some());
        assert!(Emulator::of(&[]).is_none());
    }
}
