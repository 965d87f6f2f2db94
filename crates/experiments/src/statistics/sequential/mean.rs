//! Sequential test of a mean.
use super::Side;

/// Smallest number of runs before a decision. The error bound is asymptotic, so that it needs some
/// runs.
const FIRST: u64 = 100;

/// Number of runs that the limits are tuned for.
const TUNED: f64 = 200.0;

/// Sequential test that a mean is above or below a bound.
///
/// The limits are asymptotic: for many runs, they are wrong at any later number of runs with a
/// probability of at most α each. They assume a finite variance, and no bound of the values.
///
/// # Source
///
/// I. Waudby-Smith, D. Arbour, R. Sinha, E. H. Kennedy and A. Ramdas, Annals of Statistics 52
/// (2024), 2613-2640.
#[derive(Clone, Debug, PartialEq)]
pub struct MeanTest {
    bound: f64,
    alpha: f64,
    low: Moments,
    high: Moments,
    decided: Option<Side>,
}

/// Number, mean and sum of squared deviations of values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Moments {
    runs: u64,
    mean: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, value: f64) {
        self.runs += 1;
        let from = value - self.mean;
        self.mean += from / self.runs as f64;
        self.squares += from * (value - self.mean);
    }

    /// Returns the distance of a limit from the mean.
    fn distance(&self, alpha: f64) -> f64 {
        let n = self.runs as f64;
        if self.runs < 2 {
            return f64::INFINITY;
        }
        // The square of the parameter ρ in the paper.
        let twice = 2.0 * alpha;
        let rho2 = (-2.0 * twice.ln() + (-2.0 * twice.ln()).ln_1p()) / TUNED;
        let spread = n * rho2 + 1.0;
        let log = (spread.sqrt() / twice).ln_1p();
        let variance = self.squares / (n - 1.0);
        (variance * 2.0 * spread / (n * n * rho2) * log).sqrt()
    }
}

impl MeanTest {
    /// Creates a test that decides for a wrong side with a probability of about `alpha` at most.
    pub fn new(bound: f64, alpha: f64) -> MeanTest {
        MeanTest {
            bound,
            alpha,
            low: Moments::default(),
            high: Moments::default(),
            decided: None,
        }
    }

    /// Adds a run with the smallest and the largest possible value. They may be infinite. Returns
    /// the side if the test has decided. Runs after the decision are ignored.
    pub fn add(&mut self, low: f64, high: f64) -> Option<Side> {
        if self.decided.is_some() {
            return self.decided;
        }
        self.low.add(low);
        self.high.add(high);
        // A value that is certainly infinite decides at once.
        self.decided = if low == f64::INFINITY {
            Some(Side::Above)
        } else if high == f64::NEG_INFINITY {
            Some(Side::Below)
        } else if self.runs() < FIRST {
            None
        } else {
            let (low, high) = self.interval();
            let below = (high < self.bound).then_some(Side::Below);
            (low > self.bound).then_some(Side::Above).or(below)
        };
        self.decided
    }

    /// Returns the number of runs until the decision, or of all runs.
    pub const fn runs(&self) -> u64 {
        self.low.runs
    }

    /// Returns a lower and an upper limit of the mean. Each limit is wrong with a probability of
    /// about α at most, at any number of runs from 100.
    pub fn interval(&self) -> (f64, f64) {
        let limit = |moments: &Moments, sign: f64| {
            let limit = moments.mean + sign * moments.distance(self.alpha);
            // The moments of infinite values are undefined.
            if limit.is_nan() {
                sign * f64::INFINITY
            } else {
                limit
            }
        };
        if self.low.mean == f64::INFINITY {
            (f64::INFINITY, f64::INFINITY)
        } else if self.high.mean == f64::NEG_INFINITY {
            (f64::NEG_INFINITY, f64::NEG_INFINITY)
        } else {
            (limit(&self.low, -1.0), limit(&self.high, 1.0))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a test with 200 values whose mean is 10 and whose standard deviation is about 1.
    fn sample(bound: f64) -> MeanTest {
        let mut test = MeanTest::new(bound, 0.05);
        for run in 0..200 {
            let value = if run % 2 == 0 { 9.0 } else { 11.0 };
            test.add(value, value);
        }
        test
    }

    #[test]
    fn limits_are_wider_than_those_of_a_fixed_number_of_runs() {
        let test = sample(10.0);
        assert_eq!(test.decided, None);
        let (low, high) = test.interval();
        assert!((low + high - 20.0).abs() < 1e-9);
        let fixed = 1.645 * f64::sqrt(200.0 / 199.0 / 200.0);
        let ratio = (high - low) / 2.0 / fixed;
        assert!((1.3..1.8).contains(&ratio), "{ratio}");
        assert_eq!(sample(9.0).decided, Some(Side::Above));
        assert_eq!(sample(11.0).decided, Some(Side::Below));
        assert_eq!(sample(9.0).runs(), FIRST);
    }

    /// A run that was stopped at 12 may take any longer time.
    #[test]
    fn a_stopped_run_has_no_upper_limit() {
        let mut test = MeanTest::new(100.0, 0.05);
        for _ in 0..500 {
            test.add(10.0, 11.0);
        }
        assert_eq!(test.decided, Some(Side::Below));
        let mut stopped = MeanTest::new(100.0, 0.05);
        stopped.add(12.0, f64::INFINITY);
        for _ in 0..500 {
            assert_eq!(stopped.add(10.0, 11.0), None);
        }
        assert_eq!(stopped.interval().1, f64::INFINITY);
        // The lower limit stays known, so that the mean can be above a bound.
        let mut above = MeanTest::new(5.0, 0.05);
        above.add(12.0, f64::INFINITY);
        let decided = (0..500).find_map(|_| above.add(10.0, f64::INFINITY));
        assert_eq!(decided, Some(Side::Above));
    }

    #[test]
    fn a_run_that_never_completes_decides() {
        let mut test = MeanTest::new(100.0, 0.05);
        test.add(10.0, 10.0);
        let never = f64::INFINITY;
        assert_eq!(test.add(never, never), Some(Side::Above));
        assert_eq!(test.interval(), (never, never));
        let mut difference = MeanTest::new(0.0, 0.05);
        assert_eq!(difference.add(-never, -never), Some(Side::Below));
    }
}
