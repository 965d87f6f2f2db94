//! Sequential test of a probability.
use statrs::function::beta::{beta_reg, ln_beta};

use super::Side;

/// Parameter of the Beta distribution that weights the alternatives (Jeffreys' prior).
const PRIOR: f64 = 0.5;

/// Sequential test that a probability is above or below a bound.
///
/// Without a margin, each alternative on one side of the bound gets a weight, and the evidence is
/// the weighted likelihood ratio. Under the other side, it exceeds 1/α with a probability of at most
/// α, for all numbers of runs together (Ville's inequality). With a margin δ, the test is Wald's
/// sequential probability ratio test of bound - δ against bound + δ.
///
/// # Source
///
/// H. Robbins, Annals of Mathematical Statistics 41 (1970), 1397-1409. A. Wald, Annals of
/// Mathematical Statistics 16 (1945), 117-186.
#[derive(Clone, Debug, PartialEq)]
pub struct ShareTest {
    bound: f64,
    margin: f64,
    alpha: f64,
    runs: u64,
    /// Number of runs that certainly had the event.
    certain: u64,
    /// Number of runs that may have had the event.
    possible: u64,
    decided: Option<Side>,
}

impl ShareTest {
    /// Creates a test of a bound between 0 and 1, both excluded. It decides for a wrong side with
    /// a probability of at most `alpha`. With a `margin`, this is valid only if the probability
    /// differs from the bound by at least the margin.
    pub const fn new(bound: f64, margin: f64, alpha: f64) -> ShareTest {
        ShareTest {
            bound,
            margin,
            alpha,
            runs: 0,
            certain: 0,
            possible: 0,
            decided: None,
        }
    }

    /// Adds a run. `happened` is `None` if it is unknown whether the event happened. Returns the
    /// side if the test has decided. Runs after the decision are ignored.
    pub fn add(&mut self, happened: Option<bool>) -> Option<Side> {
        if self.decided.is_some() {
            return self.decided;
        }
        self.runs += 1;
        self.certain += u64::from(happened == Some(true));
        self.possible += u64::from(happened != Some(false));
        let threshold = -self.alpha.ln();
        self.decided = if self.evidence_above() >= threshold {
            Some(Side::Above)
        } else if self.evidence_below() >= threshold {
            Some(Side::Below)
        } else {
            None
        };
        self.decided
    }

    /// Returns the number of runs until the decision, or of all runs.
    pub const fn runs(&self) -> u64 {
        self.runs
    }

    /// Returns a lower and an upper limit of the probability. Each limit is wrong with a
    /// probability of at most α, at any number of runs.
    pub fn interval(&self) -> (f64, f64) {
        let threshold = -self.alpha.ln();
        let (yes, no) = (self.certain as f64, (self.runs - self.certain) as f64);
        let low = last_rejected(yes / (yes + no), |bound| {
            weighted_ratio(yes, no, bound) >= threshold
        });
        let (yes, no) = (self.possible as f64, (self.runs - self.possible) as f64);
        let high = last_rejected(no / (yes + no), |bound| {
            weighted_ratio(no, yes, bound) >= threshold
        });
        (low, 1.0 - high)
    }

    /// Returns the logarithm of the evidence that the probability is above the bound.
    fn evidence_above(&self) -> f64 {
        let (yes, no) = (self.certain as f64, (self.runs - self.certain) as f64);
        if self.margin > 0.0 {
            self.ratio(yes, no)
        } else {
            evidence(yes, no, self.bound)
        }
    }

    /// Returns the logarithm of the evidence that the probability is below the bound.
    fn evidence_below(&self) -> f64 {
        let (yes, no) = (self.possible as f64, (self.runs - self.possible) as f64);
        if self.margin > 0.0 {
            -self.ratio(yes, no)
        } else {
            evidence(no, yes, 1.0 - self.bound)
        }
    }

    /// Returns the logarithm of the likelihood ratio of bound + margin to bound - margin.
    fn ratio(&self, yes: f64, no: f64) -> f64 {
        let [low, high] = [self.bound - self.margin, self.bound + self.margin];
        let [low, high] = [low.max(0.0), high.min(1.0)];
        times_ln(yes, high) + times_ln(no, 1.0 - high)
            - times_ln(yes, low)
            - times_ln(no, 1.0 - low)
    }
}

/// Returns `n ln(p)`, and 0 for `n` = 0.
fn times_ln(n: f64, p: f64) -> f64 {
    if n == 0.0 { 0.0 } else { n * p.ln() }
}

/// Returns the logarithm of the evidence that a probability is above `bound`. Returns 0 if the
/// evidence is at most 1.
fn evidence(yes: f64, no: f64, bound: f64) -> f64 {
    // Below the bound, all likelihood ratios are at most 1.
    if yes <= bound * (yes + no) {
        return 0.0;
    }
    weighted_ratio(yes, no, bound)
}

/// Returns the logarithm of the weighted likelihood ratio of all probabilities above `bound` to
/// `bound`.
fn weighted_ratio(yes: f64, no: f64, bound: f64) -> f64 {
    // The regularized beta function of the complement is the share of the weights above the bound.
    let above = beta_reg(no + PRIOR, yes + PRIOR, 1.0 - bound).ln();
    let weighted = ln_beta(yes + PRIOR, no + PRIOR) + above;
    // The sum of all weights above the bound, in closed form for Jeffreys' prior.
    let weights = 2.0 * (1.0 - bound).sqrt().asin();
    weighted - weights.ln() - times_ln(yes, bound) - times_ln(no, 1.0 - bound)
}

/// Returns the largest bound below `estimate` that is rejected, by bisection. Returns 0 if no bound
/// is rejected.
fn last_rejected(estimate: f64, is_rejected: impl Fn(f64) -> bool) -> f64 {
    /// Number of bisections. The last interval is shorter than a rounding error of a probability.
    const STEPS: u32 = 52;
    let (mut low, mut high) = (0.0, estimate);
    if high.is_nan() || high <= 0.0 {
        return 0.0;
    }
    for _ in 0..STEPS {
        let middle = 0.5 * (low + high);
        if middle > 0.0 && is_rejected(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integrates the likelihood ratio numerically, with the weights of the prior.
    #[test]
    fn the_weighted_ratio_is_an_integral() {
        let (yes, no, bound) = (17.0, 3.0, 0.6);
        let steps = 1_000_000;
        let [mut all, mut weights] = [0.0; 2];
        for step in 0..steps {
            let p = bound + (1.0 - bound) * (f64::from(step) + 0.5) / f64::from(steps);
            let weight = (p * (1.0 - p)).powf(PRIOR - 1.0);
            let ratio = (p / bound).powf(yes) * ((1.0 - p) / (1.0 - bound)).powf(no);
            all += weight * ratio;
            weights += weight;
        }
        let exact = weighted_ratio(yes, no, bound);
        let integral = f64::ln(all / weights);
        assert!((exact - integral).abs() < 1e-3, "{exact} {integral}");
    }

    /// The expectation of the evidence after each run is the evidence before it, at the bound.
    #[test]
    fn the_evidence_is_a_martingale_at_the_bound() {
        for (yes, no, bound) in [(0.0, 0.0, 0.3), (5.0, 2.0, 0.95), (40.0, 60.0, 0.5)] {
            let [now, more, fewer] = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]
                .map(|(a, b)| weighted_ratio(yes + a, no + b, bound).exp());
            let next = bound * more + (1.0 - bound) * fewer;
            assert!((next / now - 1.0).abs() < 1e-9, "{next} {now}");
        }
    }

    #[test]
    fn a_test_without_margin_decides_when_its_limit_passes_the_bound() {
        let mut test = ShareTest::new(0.8, 0.0, 0.05);
        while test.add(Some(true)).is_none() {
            assert!(test.interval().0 < 0.8);
        }
        assert_eq!(test.decided, Some(Side::Above));
        assert!(test.interval().0 >= 0.8);
        assert_eq!(test.interval().1, 1.0);
        assert_eq!(test.runs(), 17);
    }

    /// A run in doubt never supports a decision.
    #[test]
    fn runs_in_doubt_decide_nothing() {
        for margin in [0.0, 0.02] {
            let mut test = ShareTest::new(0.9, margin, 0.05);
            for _ in 0..1000 {
                assert_eq!(test.add(None), None);
            }
            assert_eq!(test.interval(), (0.0, 1.0));
        }
    }

    /// Checks Wald's approximation of the number of runs, ln((1 - α)/α) divided by the information
    /// of a run.
    #[test]
    fn a_margin_gives_the_sequential_probability_ratio_test() {
        let mut test = ShareTest::new(0.5, 0.1, 0.05);
        // ln 20 = 2.996, and each run with the event adds ln(0.6 / 0.4) = 0.405.
        let decided = (1..).find(|_| test.add(Some(true)).is_some());
        assert_eq!(decided, Some(8));
        // Within the margin of 1, one run without the event is impossible.
        let mut certain = ShareTest::new(0.99, 0.02, 0.05);
        assert_eq!(certain.add(Some(false)), Some(Side::Below));
    }
}
