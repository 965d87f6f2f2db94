//! Quantiles of a sample.

/// Returns the quantile `q` of a sample, or `None` if the sample is empty. `q` is from 0 to 1.
/// Interpolates like [`stochc_estimate::quantile`].
pub fn quantile(values: &[f64], q: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    stochc_estimate::quantile(&sorted, q)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_in_any_order() {
        assert_eq!(quantile(&[8.0, 1.0, 4.0, 2.0], 0.5), Some(3.0));
    }
}
