//! Quantiles and probabilities of distributions, computed by `statrs`.
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Confidence level of every interval.
const LEVEL: f64 = 0.95;

/// Returns the half-width of a 95 % interval as a multiple of the standard error, by Student's t.
///
/// `freedom` is the number of degrees of freedom, which must be positive. For 49, the result is
/// 2.0096.
pub(super) fn t_quantile(freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, freedom)
        .expect("the degrees of freedom are positive")
        .inverse_cdf(0.5 + LEVEL / 2.0)
}

/// Returns the probability that |T| is at least `t` under Student's t.
pub(super) fn t_two_sided(t: f64, freedom: f64) -> f64 {
    let t_distribution =
        StudentsT::new(0.0, 1.0, freedom).expect("the degrees of freedom are positive");
    2.0 * t_distribution.sf(t.abs())
}

/// Returns 1.96, the result of [`t_quantile`] for a normal distribution.
pub(super) fn normal_quantile() -> f64 {
    normal_quantile_of(0.5 + LEVEL / 2.0)
}

/// Returns the quantile of the standard normal distribution at a probability.
pub(super) fn normal_quantile_of(probability: f64) -> f64 {
    Normal::standard().inverse_cdf(probability)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with `scipy.stats.t.ppf(0.975, df)` and `2 * scipy.stats.t.sf(5, df)`, scipy
    /// 1.17.1.
    #[test]
    fn student_t_agrees_with_scipy() {
        for (freedom, quantile, tail) in [
            (1.0, 12.706204736174694, 0.1256659163780024),
            (2.0, 4.302652729749462, 0.037749551350623724),
            (3.7, 2.8675207071911895, 0.009163967644893314),
            (49.0, 2.0095752371292392, 7.736116446289065e-6),
            (98.0, 1.9844674545084815, 2.51357798323805e-6),
            (1000.0, 1.9623390808264083, 6.767256364648635e-7),
        ] {
            assert!((t_quantile(freedom) / quantile - 1.0).abs() < 1e-9);
            assert!((t_two_sided(-5.0, freedom) / tail - 1.0).abs() < 1e-9);
        }
    }

    /// Compares with `scipy.stats.norm.ppf(0.975)`.
    #[test]
    fn the_normal_distribution_agrees_with_scipy() {
        assert!((normal_quantile() - 1.959963984540054).abs() < 1e-12);
    }
}
