//! Ratio of two means.
use serde::{Deserialize, Serialize};

use super::distribution::t_quantile;
use super::runs::comparable;
use super::{Observation, Summary};

/// Relative difference of two means: 0.04 if the first is 4 % larger.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Relative {
    /// First mean divided by the second mean, minus one.
    pub value: f64,
    /// Half-width of the 95 % interval. `None` for too few runs.
    pub half_width: Option<f64>,
    /// Horizon of both means, in the unit of the times. Longer times are replaced by the horizon.
    /// `None` if all times are complete.
    pub horizon: Option<f64>,
}

/// Mean of a sample, with the standard error and the degrees of freedom for its interval.
struct MeanEstimate {
    mean: f64,
    /// Standard error of the mean. `None` for a single run.
    error: Option<f64>,
    freedom: f64,
}

/// Returns the relative difference of the means of two samples. Returns `None` without times, or if
/// the second mean is 0.
///
/// The delta method, applied to the logarithm of the ratio, gives the interval. The degrees of
/// freedom are those of Welch and Satterthwaite. With censoring, both means are restricted to the
/// time range that both samples cover.
pub fn relative(first: &[Observation], second: &[Observation]) -> Option<Relative> {
    let both = comparable(first, second)?;
    let [a, b] = both.values;
    let a = MeanEstimate::from_values(&a, both.unseen[0])?;
    let b = MeanEstimate::from_values(&b, both.unseen[1])?;
    let ratio = a.mean / b.mean;
    if !ratio.is_finite() {
        return None;
    }
    let half_width = (a.error.zip(b.error)).map(|(ea, eb)| {
        let (va, vb) = ((ea / b.mean).powi(2), (ratio * eb / b.mean).powi(2));
        let variance = va + vb;
        if variance > 0.0 {
            let parts = va.powi(2) / a.freedom + vb.powi(2) / b.freedom;
            t_quantile(variance.powi(2) / parts) * variance.sqrt()
        } else {
            0.0
        }
    });
    Some(Relative {
        value: ratio - 1.0,
        half_width,
        horizon: both.horizon,
    })
}

impl MeanEstimate {
    fn from_values(values: &[f64], unseen: f64) -> Option<MeanEstimate> {
        let summary = Summary::from_values(values)?;
        Some(MeanEstimate {
            mean: summary.mean,
            error: summary
                .sd
                .map(|sd| (sd / (summary.n as f64).sqrt()).hypot(unseen)),
            freedom: (summary.n - 1) as f64,
        })
    }
}

impl Relative {
    /// Returns whether the relative difference is significant: its interval excludes 0.
    pub fn is_known(&self) -> bool {
        self.half_width.is_some_and(|half| self.value.abs() > half)
    }

    /// Returns the largest absolute value in the interval: a bound on the bias. Returns `None` if
    /// there is no interval.
    pub fn bound(&self) -> Option<f64> {
        Some(self.value.abs() + self.half_width?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn completed(times: &[f64]) -> Vec<Observation> {
        times.iter().copied().map(Observation::completed).collect()
    }

    /// Compares with a calculation by hand. The means are 11 and 10, the standard errors 1 / sqrt 3
    /// and sqrt(4 / 3). The standard error of the ratio is sqrt((1 / 3) / 100 + 1.21 (4 / 3) /
    /// 100). Degrees of freedom and quantile are from scipy 1.17.1.
    #[test]
    fn a_ratio_agrees_with_its_closed_form() {
        let found = relative(
            &completed(&[10.0, 11.0, 12.0]),
            &completed(&[8.0, 10.0, 12.0]),
        );
        let found = found.unwrap();
        assert!((found.value - 0.1).abs() < 1e-12);
        assert!(
            (found.half_width.unwrap() - 0.4632746079506003).abs() < 1e-9,
            "{found:?}"
        );
        assert!((found.bound().unwrap() - 0.1 - 0.4632746079506003).abs() < 1e-9);
        assert_eq!(found.horizon, None);
    }

    #[test]
    fn one_run_has_no_interval_and_none_no_ratio() {
        let one = relative(&completed(&[4.0]), &completed(&[2.0, 2.0])).unwrap();
        assert_eq!((one.value, one.half_width, one.bound()), (1.0, None, None));
        assert_eq!(relative(&[], &completed(&[2.0])), None);
        assert_eq!(relative(&completed(&[2.0]), &completed(&[0.0])), None);
    }

    /// Checks a sample of four runs that do not complete before 300. In the other sample, one run
    /// in twenty completes before 300. This is not a significant difference.
    #[test]
    fn uninformative_runs_have_a_wide_interval() {
        let mut reference = vec![Observation::competing(300.0); 95];
        reference.extend(completed(&[150.0; 5]));
        let never = [Observation::competing(300.0); 4];
        let found = relative(&never, &reference).unwrap();
        assert!((found.value - (300.0 / 292.5 - 1.0)).abs() < 1e-12);
        assert!(
            !found.is_known() && found.half_width.unwrap() > 0.49,
            "{found:?}"
        );
    }

    /// Checks the means (2 + 9) / 2 and (4 + 6) / 2. The second mean is known for all times,
    /// because both runs completed.
    #[test]
    fn a_censored_mean_is_restricted_to_its_horizon() {
        let first = [Observation::completed(2.0), Observation::censored(9.0)];
        let second = completed(&[4.0, 6.0]);
        let found = relative(&first, &second).unwrap();
        assert!((found.value - 0.1).abs() < 1e-12);
        assert_eq!(found.horizon, Some(9.0));
        let back = relative(&second, &first).unwrap();
        assert!((back.value - (1.0 / 1.1 - 1.0)).abs() < 1e-12);
    }

    /// Checks the means up to a common horizon of 5: (2 + 5) / 2 and (4 + 5) / 2.
    #[test]
    fn two_censored_means_share_a_horizon() {
        let first = [Observation::completed(2.0), Observation::censored(9.0)];
        let second = [Observation::completed(4.0), Observation::censored(5.0)];
        let found = relative(&first, &second).unwrap();
        assert!((found.value - (3.5 / 4.5 - 1.0)).abs() < 1e-12);
        assert_eq!(found.horizon, Some(5.0));
    }
}
