//! Estimates from the runs that confirm an optimum.
use super::Objective;
use crate::Estimate;
use crate::resampling::{SAMPLES, weights};
use crate::statistics::share_interval;

/// Estimates the objective from the times of runs, by bootstrap. Probabilities have Wilson's
/// interval. Returns `None` without runs.
pub fn estimate(objective: Objective, times: &[f64], seed: u64) -> Option<Estimate> {
    if let Objective::Exceeds(time) = objective {
        let longer = times.iter().filter(|it| **it > time).count();
        let (low, high) = share_interval(longer, times.len())?;
        let value = longer as f64 / times.len() as f64;
        return Some(Estimate { value, low, high });
    }
    Estimate::from_resampled(&resampled(objective, times, seed))
}

/// Returns the objective of the times of runs, and then of each bootstrap sample of the runs. NaN
/// if a sample is empty.
pub fn resampled(objective: Objective, times: &[f64], seed: u64) -> Vec<f64> {
    let runs = 0..times.len() as u64;
    let weights: Vec<_> = runs.map(|run| weights(seed, run)).collect();
    let of = |weight: &dyn Fn(usize) -> f64| {
        let weighted = times.iter().enumerate();
        let weighted = weighted.map(|(run, time)| (*time, weight(run)));
        objective.of_sample(weighted).unwrap_or(f64::NAN)
    };
    let samples = (0..SAMPLES).map(|sample| of(&|run| f64::from(weights[run][sample])));
    std::iter::once(of(&|_| 1.0)).chain(samples).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elasticity;

    /// Returns evenly spread quantiles of an exponential distribution, in a fixed random order.
    fn times(mean: f64) -> Vec<f64> {
        let share = |i: usize| ((i * 37 % 101) as f64 + 0.5) / 101.0;
        (0..101).map(|i| -mean * (1.0 - share(i)).ln()).collect()
    }

    #[test]
    fn the_interval_of_a_mean_is_as_wide_as_by_students_t() {
        let times = times(500.0);
        let found = estimate(Objective::Mean, &times, 3).unwrap();
        let expected = crate::statistics::Summary::from_values(&times).unwrap();
        let half = expected.half_width.unwrap();
        assert!((found.value - expected.mean).abs() < 1e-9);
        let ratio = (found.high - found.low) / 2.0 / half;
        assert!((0.75..1.25).contains(&ratio), "{ratio}");
    }

    #[test]
    fn a_probability_of_zero_has_an_interval() {
        let found = estimate(Objective::Exceeds(9.0), &[1.0; 50], 3).unwrap();
        assert_eq!((found.value, found.low), (0.0, 0.0));
        assert!((0.07..0.072).contains(&found.high), "{found:?}");
    }

    #[test]
    fn quantiles_and_probabilities_have_elasticities() {
        // A power law with exponent -1.5.
        let (low, high) = (times(500.0), times(500.0 * 1.2f64.powf(-1.5)));
        let found = |objective| {
            let [low, high] = [&low, &high].map(|times| resampled(objective, times, 3));
            elasticity(&[vec![(0.0, &*low), (1.2f64.ln(), &*high)]])
        };
        let quantile = found(Objective::Quantile(0.9)).unwrap();
        for value in [quantile.value, quantile.low, quantile.high] {
            assert!((value + 1.5).abs() < 1e-9, "{quantile:?}");
        }
        assert_eq!(found(Objective::Exceeds(1e6)), None);
    }
}
