//! Significance of the difference of two programs: Student's t test on comparable means.
//!
//! The same estimate and test serve complete and censored times. If times are censored, both means
//! are restricted to the time range that both samples cover. Each run counts with its contribution
//! to the mean ([`super::KaplanMeier::contributions`]). The contribution is its time if all times
//! are known. Estimate, interval and p are thus consistent, and do not change abruptly with the
//! first censored run.
use serde::Serialize;

use super::distribution::{normal_quantile_of, t_quantile, t_two_sided};
use super::holm::holm;
use super::runs::{Runs, comparable};
use super::summary::Summary;

/// Significance level. The p-value of a difference is below it if the 95 % interval excludes zero.
pub const SIGNIFICANT: f64 = 0.05;

/// Relative difference between programs that is large enough to matter.
pub const DETECTABLE: f64 = 0.05;

/// Probability that the suggested number of runs detects a relative difference of
/// [`DETECTABLE`].
pub const POWER: f64 = 0.8;

/// Estimated difference of the means of two samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Test that gave the p-value.
    pub test: Test,
    /// Horizon: end of the time range that both samples cover. Longer times are replaced by the
    /// horizon. `None` if all times are known.
    pub horizon: Option<f64>,
    /// Mean of the first sample minus mean of the second, in the unit of the times.
    pub difference: f64,
    /// Half-width of the 95 % confidence interval of the difference.
    pub half_width: f64,
    /// Probability of a difference at least this large if the true difference were zero.
    pub p: f64,
    /// The p-value `p`, corrected by Holm's method for the number of reported differences (S. Holm,
    /// 1979).
    pub p_holm: f64,
    /// Sample with the significantly longer times.
    pub longer: Longer,
    /// Number of runs of each program that detects a difference of 5 % of the mean with a
    /// probability of 80 %. `None` if the mean is 0.
    pub runs_for_5_percent: Option<u64>,
}

/// Statistical test of two samples.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Test {
    /// Student's t test of the differences within pairs, for samples with equal seeds.
    Paired {
        /// Number of pairs.
        pairs: usize,
    },
    /// Welch's two-sided t test, for independent samples with unequal variances.
    Welch {
        /// Number of degrees of freedom by Welch and Satterthwaite.
        freedom: f64,
    },
}

/// Sample with the longer mean time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Longer {
    /// The first program takes longer.
    First,
    /// The second program takes longer.
    Second,
    /// The difference is not significant, possibly because of the correction for the number of
    /// differences.
    NotSignificant,
}

/// Compares two samples. Returns `None` for too few runs, or if all times are equal.
///
/// If both samples have the same seed, runs with the same number are paired. Then runs without a
/// partner are ignored.
pub fn compare(first: &Runs, second: &Runs) -> Option<Difference> {
    let is_paired = first.seed == second.seed;
    let (ours, theirs) = if is_paired {
        (first.shared(second), second.shared(first))
    } else {
        (first.observations(), second.observations())
    };
    let both = comparable(&ours, &theirs)?;
    let [a, b] = &both.values;
    let estimate = if is_paired { paired(a, b) } else { welch(a, b) };
    let (test, freedom, difference, error) = estimate?;
    if error <= 0.0 {
        return None;
    }
    let mean = (mean(a) + mean(b)) / 2.0;
    let runs_for_5_percent = runs_to_detect(DETECTABLE * mean, test, error, [a.len(), b.len()]);
    let error = (both.unseen.into_iter()).fold(error, f64::hypot);
    let p = t_two_sided(difference / error, freedom);
    Some(Difference {
        test,
        horizon: both.horizon,
        difference,
        half_width: t_quantile(freedom) * error,
        p,
        p_holm: p,
        longer: Longer::from_p(difference, p),
        runs_for_5_percent,
    })
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Returns the number of runs of each program that detects a `difference` with a probability of
/// [`POWER`].
///
/// `error` is the standard error of the difference with the present numbers of `runs`. Returns
/// `None` if the difference is not positive, or on overflow.
///
/// # Source
///
/// W. C. Guenther, The American Statistician 35, 243-244 (1981).
fn runs_to_detect(difference: f64, test: Test, error: f64, runs: [usize; 2]) -> Option<u64> {
    let significance = normal_quantile_of(1.0 - SIGNIFICANT / 2.0);
    let noise = (significance + normal_quantile_of(POWER)) * error / difference;
    // For samples of different sizes, use the harmonic mean of the sizes.
    let [first, second] = runs.map(|runs| runs as f64);
    let (runs, small) = match test {
        Test::Paired { pairs } => (pairs as f64, significance.powi(2) / 2.0),
        Test::Welch { .. } => (
            2.0 * first * second / (first + second),
            significance.powi(2) / 4.0,
        ),
    };
    let needed = (noise.powi(2) * runs + small).ceil();
    (difference > 0.0 && needed < 1e15).then_some(needed as u64)
}

impl Difference {
    /// Multiplies all times by a factor, to convert their unit.
    pub(crate) fn scale(&mut self, factor: f64) {
        self.difference *= factor;
        self.half_width *= factor;
        self.horizon.iter_mut().for_each(|it| *it *= factor);
    }
}

/// Applies Holm's correction to the p-values of all reported differences. Updates the conclusions.
pub fn correct<'a>(differences: impl Iterator<Item = &'a mut Difference>) {
    let differences: Vec<&mut Difference> = differences.collect();
    let p: Vec<f64> = differences.iter().map(|it| it.p).collect();
    for (it, p_holm) in differences.into_iter().zip(holm(&p)) {
        it.p_holm = p_holm;
        it.longer = Longer::from_p(it.difference, p_holm);
    }
}

impl Longer {
    fn from_p(difference: f64, p: f64) -> Longer {
        match p < SIGNIFICANT {
            true if difference > 0.0 => Longer::First,
            true => Longer::Second,
            false => Longer::NotSignificant,
        }
    }
}

/// Test, degrees of freedom, estimate and standard error.
type DifferenceEstimate = (Test, f64, f64, f64);

/// Computes the paired test. It requires only that the pairs are independent of each other.
///
/// # Source
///
/// Student, Biometrika 6, 1-25 (1908).
fn paired(first: &[f64], second: &[f64]) -> Option<DifferenceEstimate> {
    let differences: Vec<f64> = first.iter().zip(second).map(|(a, b)| a - b).collect();
    let summary = Summary::from_values(&differences)?;
    let error = summary.sd? / (summary.n as f64).sqrt();
    let test = Test::Paired { pairs: summary.n };
    Some((test, (summary.n - 1) as f64, summary.mean, error))
}

/// Computes Welch's test.
///
/// # Source
///
/// B. L. Welch, Biometrika 34, 28-35 (1947).
fn welch(first: &[f64], second: &[f64]) -> Option<DifferenceEstimate> {
    let (a, b) = (Summary::from_values(first)?, Summary::from_values(second)?);
    let (va, vb) = (a.sd?.powi(2) / a.n as f64, b.sd?.powi(2) / b.n as f64);
    let variance = va + vb;
    if variance <= 0.0 {
        return None;
    }
    let freedom =
        variance.powi(2) / (va.powi(2) / (a.n - 1) as f64 + vb.powi(2) / (b.n - 1) as f64);
    let test = Test::Welch { freedom };
    Some((test, freedom, a.mean - b.mean, variance.sqrt()))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::statistics::Observation;
    use crate::statistics::observation::tests::observation;

    fn runs(seed: u64, times: impl IntoIterator<Item = Observation>) -> Runs {
        Runs {
            seed,
            times: (0..).zip(times).collect(),
        }
    }

    fn completed(seed: u64, times: &[f64]) -> Runs {
        runs(seed, times.iter().copied().map(Observation::completed))
    }

    /// Compares with scipy 1.17.1: `r = ttest_ind(x, y, equal_var=False)`. `r.pvalue, r.df,
    /// r.confidence_interval()` is 0.3959250164443995, 10.777793170031504, (-1934.04877640604,
    /// 4520.132109739374).
    #[test]
    fn welch_agrees_with_scipy() {
        let x = [
            2948.0, 6611.0, 5120.0, 7303.0, 14496.0, 4410.0, 3999.0, 6120.0,
        ];
        let y = [2826.0, 5158.0, 4400.0, 5011.0, 8312.0, 4790.0];
        let found = compare(&completed(1, &x), &completed(2, &y)).unwrap();
        let Test::Welch { freedom } = found.test else {
            panic!("the seeds differ: {:?}", found.test)
        };
        assert!((freedom - 10.777793170031504).abs() < 1e-9);
        assert!((found.p - 0.3959250164443995).abs() < 1e-9);
        assert!((found.difference - found.half_width + 1934.04877640604).abs() < 1e-5);
        assert!((found.difference + found.half_width - 4520.132109739374).abs() < 1e-5);
    }

    /// Compares with Student's own example: extra hours of sleep of ten patients under two drugs.
    /// In R, `t.test(extra ~ group, sleep, paired = TRUE)` gives a mean of -1.58 and p = 0.002833.
    /// The interval is -2.4598858, -0.7001142.
    #[test]
    fn reproduces_students_example() {
        let first = [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0];
        let second = [1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4];
        // Shifted by a constant to positive times.
        let [first, second] = [first, second].map(|it| completed(1, &it.map(|h| h + 10.0)));
        let found = compare(&first, &second).unwrap();
        assert_eq!(found.test, Test::Paired { pairs: 10 });
        assert_eq!((found.horizon, found.longer), (None, Longer::Second));
        assert!((found.difference + 1.58).abs() < 1e-12);
        assert!((found.p - 0.00283289).abs() < 1e-8, "{found:?}");
        assert!((found.difference - found.half_width + 2.4598858).abs() < 1e-7);
    }

    /// Compares with a calculation by hand. Up to the horizon 5, the difference is (2 + 5) / 2
    /// minus (4 + 5) / 2. The contributions are 2, 5 and 4, 5.
    #[test]
    fn censored_means_are_compared_up_to_a_common_horizon() {
        let first = [Observation::completed(2.0), Observation::censored(9.0)];
        let second = [Observation::completed(4.0), Observation::censored(5.0)];
        let found = compare(&runs(1, first), &runs(1, second)).unwrap();
        assert_eq!((found.horizon, found.difference), (Some(5.0), -1.0));
        assert_eq!(found.test, Test::Paired { pairs: 2 });
    }

    /// Checks a sample whose last run completed. The time of its censored run remains unknown.
    #[test]
    fn a_censored_sample_is_known_up_to_its_last_time() {
        let first = [
            Observation::completed(2.0),
            Observation::censored(3.0),
            Observation::completed(6.0),
        ];
        let second = [4.0, 5.0, 20.0].map(Observation::completed);
        let found = compare(&runs(1, first), &runs(1, second)).unwrap();
        assert_eq!(found.horizon, Some(6.0));
        // By hand, the means are 2 + 2/3 x 4 and (4 + 5 + 6) / 3.
        assert!(
            (found.difference - (2.0 + 8.0 / 3.0 - 5.0)).abs() < 1e-12,
            "{found:?}"
        );
    }

    #[test]
    fn runs_without_a_partner_are_left_out() {
        let first = completed(1, &[10.0, 20.0, 30.0, 900.0]);
        let mut second = completed(1, &[11.0, 22.0, 33.0]);
        second.times.push((7, Observation::completed(5000.0)));
        let found = compare(&first, &second).unwrap();
        assert_eq!(
            (found.test, found.difference),
            (Test::Paired { pairs: 3 }, -2.0)
        );
    }

    #[test]
    fn small_samples_have_no_test() {
        for seed in [1, 2] {
            let of = |times: &[f64]| completed(seed, times);
            assert_eq!(compare(&completed(1, &[]), &of(&[])), None);
            assert_eq!(compare(&completed(1, &[1.0]), &of(&[2.0, 3.0])), None);
            assert_eq!(compare(&completed(1, &[2.0; 3]), &of(&[2.0; 3])), None);
            let never = [Observation::censored(9.0); 3];
            assert_eq!(compare(&runs(1, never), &runs(seed, never)), None);
        }
    }

    /// Compares with R 4.3: `power.t.test(delta = 5, sd = s, power = 0.8, type = "paired")$n`. `s`
    /// is the SD of the differences. For `type = "two.sample"`, it is the SD of each sample.
    /// Results are rounded up.
    #[test]
    fn the_runs_for_a_difference_agree_with_power_t_test() {
        for (sd, pairs, each) in [(10.0, 34, 64), (5.0, 10, 17), (100.0, 3142, 6281)] {
            let n = 20_usize;
            let paired = Test::Paired { pairs: n };
            let error = sd / (n as f64).sqrt();
            assert_eq!(runs_to_detect(5.0, paired, error, [n, n]), Some(pairs));
            let welch = Test::Welch { freedom: 38.0 };
            let error = sd * (2.0 / n as f64).sqrt();
            assert_eq!(runs_to_detect(5.0, welch, error, [n, n]), Some(each));
        }
        assert_eq!(
            runs_to_detect(0.0, Test::Paired { pairs: 3 }, 1.0, [3, 3]),
            None
        );
    }

    #[test]
    fn a_program_that_never_completes_takes_longer() {
        let stuck = runs(1, [Observation::censored(1000.0); 20]);
        let times: Vec<f64> = (0..20).map(|i| 100.0 + f64::from(i)).collect();
        let found = compare(&stuck, &completed(1, &times)).unwrap();
        assert_eq!((found.horizon, found.longer), (Some(1000.0), Longer::First));
    }

    #[test]
    fn many_differences_are_corrected() {
        let near = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0].map(|t| 10.0 * t);
        let shift = [-9.0, 2.0, -8.0, 1.0, -7.0, -3.0, -2.0, -4.0];
        let far: Vec<f64> = near.iter().zip(shift).map(|(a, b)| a - b).collect();
        let one = compare(&completed(1, &near), &completed(1, &far)).unwrap();
        assert_eq!(one.longer, Longer::Second, "{one:?}");
        let mut many = vec![one.clone(); 10];
        correct(many.iter_mut());
        assert_eq!(many[0].longer, Longer::NotSignificant);
        assert!((many[0].p_holm - 10.0 * one.p).abs() < 1e-12);
    }

    fn times() -> impl Strategy<Value = Vec<Observation>> {
        proptest::collection::vec(observation(1..500), 2..30)
    }

    proptest! {
        #[test]
        fn estimate_interval_p_and_words_agree(
            first in times(), second in times(), seed in 1_u64..3,
        ) {
            let (first, second) = (runs(1, first), runs(seed, second));
            let Some(found) = compare(&first, &second) else { return Ok(()) };
            let is_outside = found.difference.abs() > found.half_width;
            // Skip values at the edge, where rounding decides.
            if (found.p - SIGNIFICANT).abs() > 1e-9 {
                prop_assert_eq!(found.p < SIGNIFICANT, is_outside);
            }
            prop_assert_eq!(found.longer != Longer::NotSignificant, found.p < SIGNIFICANT);
            let back = compare(&second, &first).unwrap();
            prop_assert!((back.difference + found.difference).abs() < 1e-9 * (1.0 + found.difference.abs()));
            prop_assert!((back.p - found.p).abs() < 1e-9);
            prop_assert_eq!(back.longer, match found.longer {
                Longer::First => Longer::Second,
                Longer::Second => Longer::First,
                Longer::NotSignificant => Longer::NotSignificant,
            });
        }
    }

    /// Checks exponential waiting times of two programs with equal means. The samples share part of
    /// their randomness, and some times are censored. The rate of false positives is about 5 %,
    /// also with censoring.
    #[test]
    fn the_interval_has_its_coverage() {
        // SplitMix64, by G. L. Steele, D. Lea and C. H. Flood (2014).
        let mut state = 5_u64;
        let mut uniform = || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            (((mixed ^ (mixed >> 31)) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        let mut wait = || -uniform().ln();
        for (limit, seed, shared) in [(f64::INFINITY, 1, 0.5), (1.4, 1, 0.5), (1.4, 2, 0.0)] {
            let (trials, n) = (2000, 40);
            let mut wrong = 0;
            for _ in 0..trials {
                let mut both = [Vec::new(), Vec::new()];
                for _ in 0..n {
                    let common = wait();
                    for sample in &mut both {
                        let time = shared * common + (1.0 - shared) * wait();
                        sample.push(if time <= limit {
                            Observation::completed(time)
                        } else {
                            Observation::censored(limit)
                        });
                    }
                }
                let [first, second] = both;
                let found = compare(&runs(1, first), &runs(seed, second)).unwrap();
                wrong += usize::from(found.longer != Longer::NotSignificant);
            }
            // The expected number is 100, with a standard deviation of 10. Skewed waiting times
            // reduce it slightly.
            assert!((60..=140).contains(&wrong), "{wrong} at {limit}, {seed}");
        }
    }
}
