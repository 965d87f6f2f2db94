//! Correction of p-values for multiple tests: Holm's step-down method.

/// Returns corrected p-values, in the order of `p`. The probability of any false positive is then
/// below the significance level.
///
/// The k-th smallest of m values is multiplied by m - k + 1. A corrected value is at
/// least as large as the previous one. The correction is valid for any dependence of the tests.
///
/// # Source
///
/// S. Holm, Scandinavian Journal of Statistics 6, 65-70 (1979).
pub fn holm(p: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_by(|&a, &b| p[a].total_cmp(&p[b]));
    let mut corrected = vec![0.0; p.len()];
    let mut largest: f64 = 0.0;
    for (before, &i) in order.iter().enumerate() {
        let factor = (p.len() - before) as f64;
        largest = largest.max((factor * p[i]).min(1.0));
        corrected[i] = largest;
    }
    corrected
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with R 4.3: `p.adjust(c(0.01, 0.04, 0.03, 0.005), "holm")` is 0.03, 0.06, 0.06,
    /// 0.02. By hand: 0.005 x 4, 0.01 x 3, 0.03 x 2, and 0.04 x 1 raised to the previous value.
    #[test]
    fn the_corrected_values_agree_with_r() {
        let corrected = holm(&[0.01, 0.04, 0.03, 0.005]);
        for (found, expected) in corrected.iter().zip([0.03, 0.06, 0.06, 0.02]) {
            assert!((found - expected).abs() < 1e-15, "{corrected:?}");
        }
    }

    #[test]
    fn one_test_needs_no_correction_and_none_is_above_one() {
        assert_eq!(holm(&[0.2]), [0.2]);
        assert_eq!(holm(&[0.9, 0.8]), [1.0, 1.0]);
        assert!(holm(&[]).is_empty());
    }
}
