//! Quantiles of a sample.

/// The value below which a share `q` of the sample lies, 0 to 1; `None`: there are no values.
///
/// Between two values it goes in a straight line, by type 7 of R. J. Hyndman and Y. Fan, The
/// American Statistician 50 (1996), 361-365, as numpy and R do by default.
pub fn quantile(values: &[f64], q: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = q.clamp(0.0, 1.0) * sorted.len().checked_sub(1)? as f64;
    let (below, above) = (
        sorted[place.floor() as usize],
        sorted[place.ceil() as usize],
    );
    Some(below + (above - below) * place.fract())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `numpy.quantile([1, 2, 4, 8], [0, .1, .5, .9, 1])` is 1, 1.3, 3, 6.8, 8.
    #[test]
    fn quantiles_are_those_of_numpy() {
        for (q, expected) in [(0.0, 1.0), (0.1, 1.3), (0.5, 3.0), (0.9, 6.8), (1.0, 8.0)] {
            let found = quantile(&[8.0, 1.0, 4.0, 2.0], q).unwrap();
            assert!((found - expected).abs() < 1e-12, "{q}: {found}");
        }
        assert_eq!(quantile(&[], 0.5), None);
        assert_eq!(quantile(&[3.0], 0.9), Some(3.0));
    }
}
