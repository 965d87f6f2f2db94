//! Statistics of times: mean and quantiles.
use serde::Serialize;
use stochc_text::number;

use crate::LowerBoundReasons;

/// Mean and quantiles of a time \[ticks\], with half-widths of 95 % confidence intervals from
/// random variation alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Times {
    /// Mean. `None` if some cases never end.
    pub mean: Option<f64>,
    /// Half-width for the mean. Uses the normal distribution for random samples, and Student's
    /// distribution for runs. `None` without a mean, or for a single time.
    pub half_width: Option<f64>,
    /// 10th percentile. `None` if fewer than a tenth of the cases end.
    pub p10: Option<f64>,
    /// Half-width for the 10th percentile. `None` for too few cases.
    pub p10_half_width: Option<f64>,
    /// Median. `None` if fewer than half of the cases end.
    pub median: Option<f64>,
    /// Half-width for the median. `None` for too few cases.
    pub median_half_width: Option<f64>,
    /// 90th percentile. `None` if fewer than 90 % of the cases end.
    pub p90: Option<f64>,
    /// Half-width for the 90th percentile. `None` for too few cases.
    pub p90_half_width: Option<f64>,
}

impl Times {
    /// Returns the statistics of times in any order, and of `never` cases that never end. Returns
    /// `None` without cases, or if more than nine tenths never end.
    pub fn new(mut times: Vec<f64>, never: usize) -> Option<Times> {
        times.sort_unstable_by(f64::total_cmp);
        let count = times.len() as f64;
        let mean = times.iter().sum::<f64>() / count;
        let squares: f64 = times.iter().map(|time| (time - mean).powi(2)).sum();
        let is_known = never == 0 && count > 1.0;
        let half_width_of_mean = NORMAL * (squares / (count - 1.0) / count).sqrt();
        let cases = Cases {
            sorted: &times,
            never,
        };
        Some(Times {
            mean: (never == 0).then_some(mean),
            half_width: is_known.then_some(half_width_of_mean),
            p10: Some(cases.quantile(0.1)?),
            p10_half_width: cases.half_width(0.1),
            median: cases.quantile(0.5),
            median_half_width: cases.half_width(0.5),
            p90: cases.quantile(0.9),
            p90_half_width: cases.half_width(0.9),
        })
    }

    /// Returns the times as part of a sentence, as estimates or as lower bounds.
    pub fn in_words(&self, bound: LowerBoundReasons) -> String {
        let at_least = bound.prefix();
        if let (Some(mean), Some(p10), Some(p90)) = (self.mean, self.p10, self.p90) {
            return format!(
                "{at_least}{} ticks on average, {} to {} in 80 % of the runs",
                number(mean.round()),
                number(p10.round()),
                number(p90.round())
            );
        }
        let within = [
            (self.p10, "10 %"),
            (self.median, "50 %"),
            (self.p90, "90 %"),
        ];
        let is_estimate = bound.is_empty();
        let within = within.into_iter().filter_map(|(time, runs)| {
            let most = if is_estimate {
                "at most"
            } else {
                "no less than"
            };
            Some(format!("{most} {} ticks in {runs}", number(time?.round())))
        });
        within.collect::<Vec<_>>().join(", ") + " of the runs"
    }
}

/// Number of standard deviations of a 95 % interval of the normal distribution.
const NORMAL: f64 = 1.96;

/// Returns the quantile `q`, from 0 to 1, of a sorted sample. Returns `None` for an empty one.
///
/// Interpolates linearly between two values, as numpy and R do by default.
///
/// # Source
///
/// R. J. Hyndman and Y. Fan, The American Statistician 50 (1996), 361-365, type 7.
pub fn quantile(sorted: &[f64], q: f64) -> Option<f64> {
    Cases { sorted, never: 0 }.quantile(q)
}

/// Returns the quantile `q` of a sorted sample and of `never` cases that never end. Returns `None`
/// if the quantile is infinite, or if there are no cases.
pub(crate) fn quantile_of_cases(sorted: &[f64], never: usize, q: f64) -> Option<f64> {
    Cases { sorted, never }.quantile(q)
}

/// Sorted times, and the number of cases that never end.
#[derive(Clone, Copy)]
struct Cases<'a> {
    sorted: &'a [f64],
    never: usize,
}

impl Cases<'_> {
    fn count(self) -> usize {
        self.sorted.len() + self.never
    }

    /// Returns a quantile, or `None` if it is infinite or there are no cases.
    fn quantile(self, q: f64) -> Option<f64> {
        let rank = q.clamp(0.0, 1.0) * self.count().checked_sub(1)? as f64;
        let at = |rank: f64| self.sorted.get(rank as usize).copied();
        let (below, above) = (at(rank.floor())?, at(rank.ceil())?);
        Some(below + (above - below) * rank.fract())
    }

    /// Returns the half-width for a quantile. Returns `None` if an end of the interval is beyond
    /// the values.
    ///
    /// The number of values below a quantile is binomial for any distribution.
    fn half_width(self, q: f64) -> Option<f64> {
        let by = NORMAL * (q * (1.0 - q) / self.count() as f64).sqrt();
        let is_within = q - by >= 0.0 && q + by <= 1.0;
        let [low, high] = [q - by, q + by].map(|share| self.quantile(share));
        is_within.then_some((high? - low?) / 2.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with `numpy.quantile([1, 2, 4, 8], [0, .1, .5, .9, 1])`: 1, 1.3, 3, 6.8, 8.
    #[test]
    fn quantiles_agree_with_numpy() {
        for (q, expected) in [(0.0, 1.0), (0.1, 1.3), (0.5, 3.0), (0.9, 6.8), (1.0, 8.0)] {
            let found = quantile(&[1.0, 2.0, 4.0, 8.0], q).unwrap();
            assert!((found - expected).abs() < 1e-12, "{q}: {found}");
        }
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(quantile(&[3.0], 0.9), Some(3.0));
    }

    /// Checks n uniform values in (0, 1). The standard error of a quantile q is the root of q (1 -
    /// q) / n.
    #[test]
    fn intervals_agree_with_order_statistics() {
        let n = 4000;
        let times = Times::new((0..n).map(|i| f64::from(i) / f64::from(n)).collect(), 0).unwrap();
        let root = f64::from(n).sqrt();
        for (found, error) in [
            (times.p10_half_width, 0.3),
            (times.median_half_width, 0.5),
            (times.p90_half_width, 0.3),
        ] {
            assert!((found.unwrap() / (1.96 * error / root) - 1.0).abs() < 1e-2);
        }
        let of_mean = 1.96 / 12_f64.sqrt() / root;
        assert!((times.half_width.unwrap() / of_mean - 1.0).abs() < 1e-2);
        assert_eq!(Times::new(Vec::new(), 0), None);
    }

    #[test]
    fn few_values_have_no_outer_quantiles() {
        let times = Times::new((0..20).map(f64::from).collect(), 0).unwrap();
        assert_eq!((times.p10_half_width, times.p90_half_width), (None, None));
        assert!(times.median_half_width.is_some());
    }

    /// Checks 70 times from 1 to 70 and 30 infinite ones. Quantiles refer to all hundred cases, and
    /// there is no mean.
    #[test]
    fn infinite_times_are_the_slowest() {
        let times = Times::new((1..=70).map(f64::from).collect(), 30).unwrap();
        assert_eq!((times.mean, times.half_width), (None, None));
        assert!((times.p10.unwrap() - 10.9).abs() < 1e-9);
        assert!((times.median.unwrap() - 50.5).abs() < 1e-9);
        assert!(times.median_half_width.is_some());
        assert_eq!((times.p90, times.p90_half_width), (None, None));
        assert_eq!(
            times.in_words(LowerBoundReasons::default()),
            "at most 11 ticks in 10 %, at most 51 ticks in 50 % of the runs"
        );
        let most = Times::new((1..=5).map(f64::from).collect(), 95);
        assert_eq!(most, None);
    }
}
