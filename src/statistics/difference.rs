//! Whether two programs differ: Welch's t where all times are known, else the log-rank test.
use serde::Serialize;

use super::distribution::{chi_squared_above, normal_quantile, t_quantile, t_two_sided};
use super::{KaplanMeier, Observation, Summary};

/// What two samples differ by.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Difference {
    /// Which test gave `p`.
    pub test: Test,
    /// Mean of the first sample less that of the second, in the unit of the times; of the
    /// restricted means where anything is censored.
    pub difference: f64,
    /// Half the width of the 95 % confidence interval of the difference.
    pub half_width: f64,
    /// Probability of a difference at least this large between samples of one distribution.
    pub p: f64,
}

/// How two samples were compared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Test {
    /// Welch's t test, two-sided: unequal variances, nothing censored.
    Welch {
        /// Degrees of freedom by Welch and Satterthwaite.
        freedom: f64,
    },
    /// The log-rank test: of the whole curves, with censored times.
    ///
    /// It is at its best while one program's rate of completion is a multiple of the other's, and
    /// may miss curves that cross.
    LogRank {
        /// The restricted means count times up to here, the last that both samples reach.
        horizon: f64,
    },
}

/// Compares two samples; `None`: too few runs, or no spread, to tell anything.
///
/// Welch's test needs two runs on each side that do not all take the same time; the log-rank test
/// needs a completion while both sides are under observation.
pub fn compare(first: &[Observation], second: &[Observation]) -> Option<Difference> {
    let mut all = first.iter().chain(second);
    if all.all(|observation| observation.completed) {
        welch(&times(first), &times(second))
    } else {
        log_rank(first, second)
    }
}

fn times(observations: &[Observation]) -> Vec<f64> {
    observations.iter().map(|o| o.time).collect()
}

/// B. L. Welch, Biometrika 34 (1947), 28-35.
fn welch(first: &[f64], second: &[f64]) -> Option<Difference> {
    let (a, b) = (Summary::of(first)?, Summary::of(second)?);
    let (va, vb) = (a.sd?.powi(2) / a.n as f64, b.sd?.powi(2) / b.n as f64);
    let variance = va + vb;
    if variance <= 0.0 {
        return None;
    }
    let freedom =
        variance.powi(2) / (va.powi(2) / (a.n - 1) as f64 + vb.powi(2) / (b.n - 1) as f64);
    let error = variance.sqrt();
    let difference = a.mean - b.mean;
    Some(Difference {
        test: Test::Welch { freedom },
        difference,
        half_width: t_quantile(freedom) * error,
        p: t_two_sided(difference / error, freedom),
    })
}

/// N. Mantel, Cancer Chemotherapy Reports 50 (1966), 163-170; the interval is of the difference of
/// the restricted means (P. Royston and M. Parmar, BMC Med. Res. Methodol. 13 (2013), 152).
fn log_rank(first: &[Observation], second: &[Observation]) -> Option<Difference> {
    let (a, b) = (KaplanMeier::of(first)?, KaplanMeier::of(second)?);
    let (first, second) = (in_order(first), in_order(second));
    let mut completions: Vec<f64> = first
        .iter()
        .chain(&second)
        .filter(|o| o.completed)
        .map(|o| o.time)
        .collect();
    completions.sort_by(f64::total_cmp);
    completions.dedup();
    let (mut excess, mut variance) = (0.0, 0.0);
    for &t in &completions {
        let ((na, da), (nb, db)) = (at(&first, t), at(&second, t));
        let (n, d) = (na + nb, da + db);
        excess += da - d * na / n;
        if n > 1.0 {
            variance += d * na * nb * (n - d) / (n * n * (n - 1.0));
        }
    }
    if variance <= 0.0 {
        return None;
    }
    let horizon = a.last().min(b.last());
    let (ma, mb) = (a.restricted_mean(horizon), b.restricted_mean(horizon));
    Some(Difference {
        test: Test::LogRank { horizon },
        difference: ma.mean - mb.mean,
        half_width: normal_quantile() * ma.error.hypot(mb.error),
        p: chi_squared_above(excess * excess / variance),
    })
}

fn in_order(observations: &[Observation]) -> Vec<Observation> {
    let mut sorted = observations.to_vec();
    sorted.sort_by(|a, b| a.time.total_cmp(&b.time));
    sorted
}

/// How many of `sorted` were under observation at time `t`, and how many of those completed then.
fn at(sorted: &[Observation], t: f64) -> (f64, f64) {
    let here = &sorted[sorted.partition_point(|o| o.time < t)..];
    let now = here.iter().take_while(|o| o.time == t);
    (
        here.len() as f64,
        now.filter(|o| o.completed).count() as f64,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn completed(times: &[f64]) -> Vec<Observation> {
        times.iter().copied().map(Observation::completed).collect()
    }

    /// scipy 1.17.1: `r = ttest_ind(x, y, equal_var=False)`, `r.pvalue, r.df,
    /// r.confidence_interval()` = 0.3959250164443995, 10.777793170031504,
    /// (-1934.04877640604, 4520.132109739374).
    #[test]
    fn welch_agrees_with_scipy() {
        let x = [
            2948.0, 6611.0, 5120.0, 7303.0, 14496.0, 4410.0, 3999.0, 6120.0,
        ];
        let y = [2826.0, 5158.0, 4400.0, 5011.0, 8312.0, 4790.0];
        let found = compare(&completed(&x), &completed(&y)).unwrap();
        let Test::Welch { freedom } = found.test else {
            panic!("nothing is censored: {:?}", found.test)
        };
        assert!((freedom - 10.777793170031504).abs() < 1e-9);
        assert!((found.p - 0.3959250164443995).abs() < 1e-9);
        assert!((found.difference - found.half_width + 1934.04877640604).abs() < 1e-5);
        assert!((found.difference + found.half_width - 4520.132109739374).abs() < 1e-5);
    }

    /// lifelines 0.30.3: `logrank_test(t1, t2, e1, e2).p_value` = 4.168809109334511e-05 for the
    /// remissions of Freireich et al. (1963); the difference of restricted means up to 23 weeks
    /// and its half-width from `restricted_mean_survival_time` and Greenwood's sum in numpy.
    #[test]
    fn log_rank_agrees_with_lifelines() {
        let mut treated = completed(&[6.0, 6.0, 6.0, 7.0, 10.0, 13.0, 16.0, 22.0, 23.0]);
        let censored = [
            6.0, 9.0, 10.0, 11.0, 17.0, 19.0, 20.0, 25.0, 32.0, 32.0, 34.0, 35.0,
        ];
        treated.extend(censored.map(Observation::censored));
        let control = completed(&[
            1.0, 1.0, 2.0, 2.0, 3.0, 4.0, 4.0, 5.0, 5.0, 8.0, 8.0, 8.0, 8.0, 11.0, 11.0, 12.0,
            12.0, 15.0, 17.0, 22.0, 23.0,
        ]);
        let found = compare(&treated, &control).unwrap();
        assert_eq!(found.test, Test::LogRank { horizon: 23.0 });
        assert!((found.p / 4.168809109334511e-5 - 1.0).abs() < 1e-9);
        assert!((found.difference - 9.242577030812328).abs() < 1e-9);
        assert!((found.half_width - 4.068803298876649).abs() < 1e-9);
        let reversed = compare(&control, &treated).unwrap();
        assert!((reversed.p / found.p - 1.0).abs() < 1e-9);
        assert!((reversed.difference + found.difference).abs() < 1e-9);
    }

    #[test]
    fn too_little_says_nothing() {
        assert_eq!(compare(&[], &[]), None);
        assert_eq!(compare(&completed(&[1.0]), &completed(&[2.0, 3.0])), None);
        assert_eq!(compare(&completed(&[2.0; 3]), &completed(&[2.0; 3])), None);
        let never = [Observation::censored(9.0); 3];
        assert_eq!(compare(&never, &never), None);
    }
}
