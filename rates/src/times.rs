//! What many times come to.
use serde::Serialize;

/// Mean and quantiles of a time \[tick\], each with half of its 95 % interval, in which there is chance alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Times {
    /// Its mean.
    pub mean: f64,
    /// Of the mean.
    pub half_width: f64,
    /// In a tenth of all cases it is less.
    pub p10: f64,
    /// Of that; `None`: there are too few cases to say.
    pub p10_half_width: Option<f64>,
    /// In half of them.
    pub median: f64,
    /// Likewise.
    pub median_half_width: Option<f64>,
    /// In nine tenths.
    pub p90: f64,
    /// Likewise.
    pub p90_half_width: Option<f64>,
}

impl Times {
    /// Of some times, in any order; `None`: there are none.
    pub fn of(mut times: Vec<f64>) -> Option<Times> {
        times.sort_unstable_by(f64::total_cmp);
        let count = times.len() as f64;
        let mean = times.iter().sum::<f64>() / count;
        let squares: f64 = times.iter().map(|time| (time - mean).powi(2)).sum();
        let at = |share| quantile(&times, share);
        Some(Times {
            mean,
            half_width: NORMAL * (squares / (count - 1.0).max(1.0) / count).sqrt(),
            p10: at(0.1)?,
            p10_half_width: half_width(&times, 0.1),
            median: at(0.5)?,
            median_half_width: half_width(&times, 0.5),
            p90: at(0.9)?,
            p90_half_width: half_width(&times, 0.9),
        })
    }
}

impl Times {
    /// The same of those that got there, if that is at least half of `all`.
    pub fn of_most(times: Vec<f64>, all: usize) -> Option<Times> {
        match 2 * times.len() >= all {
            true => Times::of(times),
            false => None,
        }
    }
}

/// So many standard deviations to either side hold 95 % of a normal distribution.
const NORMAL: f64 = 1.96;

/// The value below which a share `q` of a sorted sample lies, 0 to 1; `None`: there are no values.
///
/// Between two values it goes in a straight line, by type 7 of R. J. Hyndman and Y. Fan, The
/// American Statistician 50 (1996), 361-365, as numpy and R do by default.
pub fn quantile(sorted: &[f64], q: f64) -> Option<f64> {
    let place = q.clamp(0.0, 1.0) * sorted.len().checked_sub(1)? as f64;
    let (below, above) = (
        sorted[place.floor() as usize],
        sorted[place.ceil() as usize],
    );
    Some(below + (above - below) * place.fract())
}

/// Half of the interval of a quantile: how many values lie below it is binomial, whatever their distribution.
fn half_width(sorted: &[f64], q: f64) -> Option<f64> {
    let count = sorted.len() as f64;
    let by = NORMAL * (q * (1.0 - q) / count).sqrt();
    let is_within = q - by >= 0.0 && q + by <= 1.0;
    let ends = [q - by, q + by].map(|share| quantile(sorted, share));
    let [Some(low), Some(high)] = ends else {
        return None;
    };
    is_within.then_some((high - low) / 2.0)
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
        let times = Times::of((0..n).map(|i| f64::from(i) / f64::from(n)).collect()).unwrap();
        let root = f64::from(n).sqrt();
        for (found, error) in [
            (times.p10_half_width, 0.3),
            (times.median_half_width, 0.5),
            (times.p90_half_width, 0.3),
        ] {
            assert!((found.unwrap() / (1.96 * error / root) - 1.0).abs() < 1e-2);
        }
        let of_mean = 1.96 / 12_f64.sqrt() / root;
        assert!((times.half_width / of_mean - 1.0).abs() < 1e-2);
        assert_eq!(Times::of(Vec::new()), None);
    }

    #[test]
    fn of_a_few_values_nothing_is_known_of_the_outer_quantiles() {
        let times = Times::of((0..20).map(f64::from).collect()).unwrap();
        assert_eq!((times.p10_half_width, times.p90_half_width), (None, None));
        assert!(times.median_half_width.is_some());
    }
}
