//! Confidence interval of a share of runs, such as the share of completed runs.
use super::distribution::normal_quantile;

/// Returns the 95 % interval of the share `k / n`. Returns `None` if the sample is empty.
///
/// The interval stays between 0 and 1. It has a positive width even if the share is 0 or 1.
///
/// # Source
///
/// E. B. Wilson, Journal of the American Statistical Association 22 (1927), 209-212.
pub fn share_interval(k: usize, n: usize) -> Option<(f64, f64)> {
    if n == 0 || k > n {
        return None;
    }
    let (z2, size) = (normal_quantile().powi(2), n as f64);
    let share = k as f64 / size;
    let middle = (share + z2 / (2.0 * size)) / (1.0 + z2 / size);
    let half =
        (z2 * (share * (1.0 - share) / size + z2 / (4.0 * size * size))).sqrt() / (1.0 + z2 / size);
    // The ends are exact, independent of rounding.
    let low = if k == 0 { 0.0 } else { middle - half };
    let high = if k == n { 1.0 } else { middle + half };
    Some((low, high))
}

/// Returns the standard error of the share of an outcome that did not occur in any of `n` runs. Its
/// [interval](share_interval) is 1.96 standard errors wide.
pub fn unseen_share_error(n: usize) -> f64 {
    share_interval(0, n).map_or(1.0, |(_, most)| most) / normal_quantile()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with `scipy.stats.binomtest(k, n).proportion_ci(method="wilson")`.
    #[test]
    fn intervals_agree_with_scipy() {
        for (k, n, low, high) in [
            (8, 10, 0.4901624715366418, 0.9433178485456248),
            (0, 5, 0.0, 0.43448246478317476),
            (5, 5, 1.0 - 0.43448246478317476, 1.0),
        ] {
            let (found_low, found_high) = share_interval(k, n).unwrap();
            assert!((found_low - low).abs() < 1e-12, "{k} of {n}: {found_low}");
            assert!(
                (found_high - high).abs() < 1e-12,
                "{k} of {n}: {found_high}"
            );
        }
        assert_eq!(share_interval(0, 0), None);
    }
}
