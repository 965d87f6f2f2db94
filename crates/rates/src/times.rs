//! What many times come to.
use serde::Serialize;

use crate::LowerBoundReasons;

/// Mean and quantiles of a time \[tick\], each with half of its 95 % interval, in which there is chance alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Times {
    /// Its mean; `None`: there are cases in which it never ends.
    pub mean: Option<f64>,
    /// Of the mean, of draws by the normal distribution and of runs by Student's; `None`: there is no mean, or only one time.
    pub half_width: Option<f64>,
    /// In a tenth of all cases it is less; `None`: in fewer.
    pub p10: Option<f64>,
    /// Of that; `None`: there are too few cases to say.
    pub p10_half_width: Option<f64>,
    /// In half of them, likewise.
    pub median: Option<f64>,
    /// Likewise.
    pub median_half_width: Option<f64>,
    /// In nine tenths, likewise.
    pub p90: Option<f64>,
    /// Likewise.
    pub p90_half_width: Option<f64>,
}

impl Times {
    /// Of some times in any order, beside cases in which it `never` ends; `None`: those are more than nine tenths, or there are no cases.
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
                "{at_least}{mean:.0} ticks on average, {p10:.0} to {p90:.0} in eight of ten runs"
            );
        }
        let within = [(self.p10, "one"), (self.median, "five"), (self.p90, "nine")];
        let is_estimate = bound.is_empty();
        let within = within.into_iter().filter_map(|(time, runs)| {
            let most = if is_estimate {
                "at most"
            } else {
                "no less than"
            };
            Some(format!("{most} {:.0} ticks in {runs}", time?))
        });
        within.collect::<Vec<_>>().join(", ") + " of ten runs"
    }
}

/// So many standard deviations to either side hold 95 % of a normal distribution.
const NORMAL: f64 = 1.96;

/// The value below which a share `q` of a sorted sample lies, 0 to 1; `None`: there are no values.
///
/// Between two values it goes in a straight line, by type 7 of R. J. Hyndman and Y. Fan, The
/// American Statistician 50 (1996), 361-365, as numpy and R do by default.
pub fn quantile(sorted: &[f64], q: f64) -> Option<f64> {
    Cases { sorted, never: 0 }.quantile(q)
}

/// Sorted times, and how many cases never end.
#[derive(Clone, Copy)]
struct Cases<'a> {
    sorted: &'a [f64],
    never: usize,
}

impl Cases<'_> {
    fn count(self) -> usize {
        self.sorted.len() + self.never
    }

    /// `None`: it is infinite, or there are no cases.
    fn quantile(self, q: f64) -> Option<f64> {
        let place = q.clamp(0.0, 1.0) * self.count().checked_sub(1)? as f64;
        let at = |place: f64| self.sorted.get(place as usize).copied();
        let (below, above) = (at(place.floor())?, at(place.ceil())?);
        Some(below + (above - below) * place.fract())
    }

    /// Half of the interval of a quantile: how many values lie below it is binomial, whatever their distribution.
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

    /// `numpy.quantile([1, 2, 4, 8], [0, .1, .5, .9, 1])` is 1, 1.3, 3, 6.8, 8.
    #[test]
    fn quantiles_are_those_of_numpy() {
        for (q, expected) in [(0.0, 1.0), (0.1, 1.3), (0.5, 3.0), (0.9, 6.8), (1.0, 8.0)] {
            let found = quantile(&[1.0, 2.0, 4.0, 8.0], q).unwrap();
            assert!((found - expected).abs() < 1e-12, "{q}: {found}");
        }
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(quantile(&[3.0], 0.9), Some(3.0));
    }

    /// Of n evenly spread values between 0 and 1, the standard error of a quantile q is the root of q (1 - q) / n.
    #[test]
    fn intervals_are_those_of_order_statistics() {
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
    fn of_a_few_values_nothing_is_known_of_the_outer_quantiles() {
        let times = Times::new((0..20).map(f64::from).collect(), 0).unwrap();
        assert_eq!((times.p10_half_width, times.p90_half_width), (None, None));
        assert!(times.median_half_width.is_some());
    }

    /// 70 times of 1 to 70 beside 30 that never come: quantiles are those of all hundred, and there is no mean.
    #[test]
    fn cases_that_never_end_are_slower_than_all_others() {
        let times = Times::new((1..=70).map(f64::from).collect(), 30).unwrap();
        assert_eq!((times.mean, times.half_width), (None, None));
        assert!((times.p10.unwrap() - 10.9).abs() < 1e-9);
        assert!((times.median.unwrap() - 50.5).abs() < 1e-9);
        assert!(times.median_half_width.is_some());
        assert_eq!((times.p90, times.p90_half_width), (None, None));
        assert_eq!(
            times.in_words(LowerBoundReasons::default()),
            "at most 11 ticks in one, at most 50 ticks in five of ten runs"
        );
        let most = Times::new((1..=5).map(f64::from).collect(), 95);
        assert_eq!(most, None);
    }
}
