//! Mean, standard deviation and order statistics of a sample without censoring.
use serde::Serialize;

use super::distribution::t_quantile;

/// Statistics of a sample. All values except `n` have the unit of the sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Size of the sample, at least 1.
    pub n: usize,
    /// Arithmetic mean.
    pub mean: f64,
    /// Standard deviation with n - 1 in the denominator. `None` if the sample has a single value.
    pub sd: Option<f64>,
    /// Half the width of the 95 % confidence interval of the mean, t(0.975, n - 1) SD / sqrt n.
    /// `None` if the sample has a single value.
    ///
    /// Papers often use 1.96 SD / sqrt n. This is 2.5 % narrower for n = 50.
    pub half_width: Option<f64>,
    /// Smallest value.
    pub min: f64,
    /// Largest value.
    pub max: f64,
    /// Median: the middle value, or the mean of the two middle values.
    pub median: f64,
}

impl Summary {
    /// Returns the statistics of finite values. Returns `None` if there are no values.
    pub fn from_values(values: &[f64]) -> Option<Summary> {
        let n = values.len();
        let median = median(values)?;
        let min = values.iter().copied().fold(f64::INFINITY, f64::min);
        let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // If all values are equal, rounding of the sum would cause a positive standard deviation.
        let mean = if min == max {
            min
        } else {
            values.iter().sum::<f64>() / n as f64
        };
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let sd = (n > 1).then(|| (squares / (n - 1) as f64).sqrt());
        Some(Summary {
            n,
            mean,
            sd,
            half_width: sd.map(|sd| t_quantile((n - 1) as f64) * sd / (n as f64).sqrt()),
            min,
            max,
            median,
        })
    }

    /// Returns the coefficient of variation, SD / mean, which has no unit. It is 1 for exponential
    /// times.
    ///
    /// Returns `None` for a single value or a mean of zero.
    pub fn cv(&self) -> Option<f64> {
        Some(self.sd? / self.mean).filter(|cv| cv.is_finite())
    }
}

/// Returns the median of finite values. For an even number of values, returns the mean of the two
/// middle ones. Returns `None` if there are no values.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let upper = *sorted.get(sorted.len() / 2)?;
    Some(if sorted.len().is_multiple_of(2) {
        0.5 * (sorted[sorted.len() / 2 - 1] + upper)
    } else {
        upper
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with numpy and scipy: `x.mean(), x.std(ddof=1), np.median(x), st.t.ppf(.975, 7) *
    /// x.std(ddof=1) / 8**.5`.
    #[test]
    fn a_sample_is_summarized_as_numpy_and_scipy_do() {
        let sample = [
            2948.0, 6611.0, 5120.0, 7303.0, 14496.0, 4410.0, 3999.0, 6120.0,
        ];
        let summary = Summary::from_values(&sample).unwrap();
        assert_eq!((summary.n, summary.mean), (8, 6375.875));
        assert!((summary.sd.unwrap() - 3580.8716990420085).abs() < 1e-8);
        assert!((summary.half_width.unwrap() - 2993.6836580708496).abs() < 1e-6);
        assert_eq!((summary.min, summary.max), (2948.0, 14496.0));
        assert_eq!(summary.median, 5620.0);
        assert!((summary.cv().unwrap() - 3580.8716990420085 / 6375.875).abs() < 1e-12);
    }

    #[test]
    fn equal_values_have_no_spread() {
        let summary = Summary::from_values(&[0.05; 300]).unwrap();
        assert_eq!(
            (summary.mean, summary.sd, summary.half_width),
            (0.05, Some(0.0), Some(0.0))
        );
    }

    #[test]
    fn one_value_has_no_spread_and_none_has_no_summary() {
        let one = Summary::from_values(&[3.0]).unwrap();
        assert_eq!((one.mean, one.sd, one.half_width), (3.0, None, None));
        assert_eq!(Summary::from_values(&[]), None);
        assert_eq!(Summary::from_values(&[0.0, 0.0]).unwrap().cv(), None);
    }
}
