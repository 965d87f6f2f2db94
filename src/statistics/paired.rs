//! Two samples whose members belong together in pairs: Student's paired t test.
use serde::Serialize;

use super::Summary;
use super::distribution::t_two_sided;

/// What pairs differ by.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Paired {
    /// How many pairs.
    pub n: usize,
    /// Mean of first less second, in the unit of the values.
    pub difference: f64,
    /// Half the width of the 95 % confidence interval of the difference.
    pub half_width: f64,
    /// Probability of a difference at least this large if it is 0 on average.
    pub p: f64,
}

/// Compares the members of pairs; `None`: fewer than two, or all differ by the same.
///
/// Only the pairs have to be independent of each other, not their members (Student, Biometrika 6
/// (1908), 1-25): programs that run with the same seed share their kicks run by run.
pub fn paired(pairs: &[(f64, f64)]) -> Option<Paired> {
    let differences: Vec<f64> = pairs.iter().map(|(first, second)| first - second).collect();
    let summary = Summary::of(&differences)?;
    let error = summary.sd? / (summary.n as f64).sqrt();
    if error <= 0.0 {
        return None;
    }
    Some(Paired {
        n: summary.n,
        difference: summary.mean,
        half_width: summary.half_width?,
        p: t_two_sided(summary.mean / error, (summary.n - 1) as f64),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Extra hours of sleep of ten patients under two drugs, Student's own example: R's
    /// `t.test(extra ~ group, sleep, paired = TRUE)` gives a mean of -1.58, p = 0.002833 and the
    /// interval -2.4598858, -0.7001142.
    #[test]
    fn students_own_example_comes_out() {
        let first = [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0];
        let second = [1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4];
        let pairs: Vec<_> = first.into_iter().zip(second).collect();
        let found = paired(&pairs).unwrap();
        assert_eq!(found.n, 10);
        assert!((found.difference + 1.58).abs() < 1e-12);
        assert!((found.p - 0.00283289).abs() < 1e-8, "{found:?}");
        assert!((found.difference - found.half_width + 2.4598858).abs() < 1e-7);
    }

    #[test]
    fn too_little_says_nothing() {
        assert_eq!(paired(&[]), None);
        assert_eq!(paired(&[(1.0, 2.0)]), None);
        assert_eq!(paired(&[(1.0, 2.0), (4.0, 5.0)]), None, "no spread");
    }
}
