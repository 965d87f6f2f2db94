//! Bootstrap over runs in a single pass. A random draw for each run gives its weight in each
//! bootstrap sample.
//!
//! Weights are Poisson with mean 1, close to the multinomial weights of the usual bootstrap for
//! many runs. They depend only on seed and run number. Sums therefore do not depend on the order of
//! runs, and all statistics of a run use the same weights.
//!
//! # Source
//!
//! J. A. Hanley and B. MacGibbon, *Computer Methods and Programs in Biomedicine* 83, 57-62 (2006).
use stochc_runtime::counter_rng::{Draws, Stream, WORDS, unit};

use crate::statistics::quantile;

/// Number of bootstrap samples.
pub const SAMPLES: usize = 200;

/// Returns the weight of a run in each bootstrap sample: the number of times that the sample
/// contains the run.
pub fn weights(seed: u64, run: u64) -> [u8; SAMPLES] {
    let mut draws = Draws::new(seed, run, Stream::Resample);
    let mut draws = draws.step(0);
    let mut weights = [0; SAMPLES];
    for (block, weights) in (0..).zip(weights.chunks_mut(WORDS as usize)) {
        for (weight, word) in weights.iter_mut().zip(draws.block(block)) {
            *weight = poisson(unit(word));
        }
    }
    weights
}

/// Returns the quantile of the Poisson distribution with mean 1 at `probability`, which is below 1.
fn poisson(probability: f64) -> u8 {
    let (mut number, mut term) = (0, (-1.0_f64).exp());
    let mut reached = term;
    // A value above 12 has a probability below 2^-33, and no random draw is that close to 1.
    while probability > reached && number < 12 {
        number += 1;
        term /= f64::from(number);
        reached += term;
    }
    number
}

/// Sum over runs, with the sum in each bootstrap sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Replicates {
    runs: usize,
    sum: f64,
    /// Sum in each bootstrap sample. Empty before the first run.
    samples: Vec<f64>,
}

/// Ratio of two sums, such as a count divided by a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ratio {
    /// Ratio over all runs.
    pub value: f64,
    /// Interval that contains the middle 95 % of the bootstrap samples. `None` for fewer than two
    /// runs.
    pub interval: Option<(f64, f64)>,
}

impl Ratio {
    /// Returns whether the interval is narrow: its half-width is at most the value itself.
    pub fn is_certain(&self) -> bool {
        (self.interval).is_some_and(|(low, high)| high - low <= 2.0 * self.value)
    }
}

impl Replicates {
    /// Adds the value `much` of a run to the sums. `weights` is the result of [`weights`] for this
    /// run.
    pub fn add(&mut self, much: f64, weights: &[u8]) {
        self.samples.resize(SAMPLES, 0.0);
        self.runs += 1;
        self.sum += much;
        for (sample, weight) in self.samples.iter_mut().zip(weights) {
            *sample += much * f64::from(*weight);
        }
    }

    /// Adds another sum over the same runs to this one.
    pub fn join(&mut self, other: &Replicates) {
        self.samples.resize(SAMPLES, 0.0);
        self.runs = self.runs.max(other.runs);
        self.sum += other.sum;
        for (sample, more) in self.samples.iter_mut().zip(&other.samples) {
            *sample += more;
        }
    }

    /// Returns the sum over all runs, and then the sum in each bootstrap sample.
    pub fn values(&self) -> Vec<f64> {
        let samples = self.samples.iter().copied();
        std::iter::once(self.sum).chain(samples).collect()
    }

    /// Returns this sum divided by `times` and by the sum `other`. Returns `None` if `other` is 0.
    pub fn over(&self, other: &Replicates, times: f64) -> Option<Ratio> {
        if other.sum <= 0.0 {
            return None;
        }
        let below = other.samples.iter().enumerate();
        let ratios = below.filter(|(_, below)| **below > 0.0).map(|(i, below)| {
            let above = self.samples.get(i).copied().unwrap_or(0.0);
            above / (below * times)
        });
        let ratios: Vec<f64> = ratios.collect();
        let interval = quantile(&ratios, 0.025).zip(quantile(&ratios, 0.975));
        Some(Ratio {
            value: self.sum / (other.sum * times),
            interval: interval.filter(|_| other.runs > 1),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_poisson_and_keyed_by_run() {
        let mut counts = [0_u32; 4];
        let runs = 500;
        for run in 0..runs {
            let weights = weights(7, run);
            assert_eq!(weights, super::weights(7, run));
            assert_ne!(weights, super::weights(8, run));
            for weight in weights {
                counts[usize::from(weight).min(3)] += 1;
            }
        }
        let all = runs as f64 * SAMPLES as f64;
        // Probabilities of 0, 1 and 2, and of all larger numbers: e^-1 (1, 1, 1/2), and the rest.
        for (count, expected) in counts.into_iter().zip([0.3679, 0.3679, 0.1839, 0.0803]) {
            let error = (expected * (1.0 - expected) / all).sqrt();
            assert!(
                (f64::from(count) / all - expected).abs() < 4.0 * error,
                "{counts:?}"
            );
        }
    }

    /// Checks that the interval covers the mean with about its nominal probability.
    #[test]
    fn intervals_contain_the_mean_in_19_of_20() {
        let ensembles = 400;
        let mut inside = 0;
        for seed in 0..ensembles {
            let (mut sum, mut number) = (Replicates::default(), Replicates::default());
            for run in 0..60 {
                let word = Draws::new(seed, run, Stream::Shuffle).step(0).block(0)[0];
                let weights = weights(seed, run);
                // Exponentially distributed with mean 1.
                sum.add(-unit(word).ln(), &weights);
                number.add(1.0, &weights);
            }
            let ratio = sum.over(&number, 1.0).unwrap();
            let (low, high) = ratio.interval.unwrap();
            assert!(low < ratio.value && ratio.value < high);
            inside += u32::from((low..=high).contains(&1.0));
        }
        // A percentile interval of 60 skewed numbers covers 93 %. The tolerance is four standard
        // deviations of a binomial.
        let share = f64::from(inside) / ensembles as f64;
        assert!((0.87..=0.99).contains(&share), "{share}");
    }

    #[test]
    fn the_order_of_runs_does_not_matter() {
        let sum = |runs: &[u64]| {
            let mut sum = Replicates::default();
            for &run in runs {
                sum.add(run as f64, &weights(1, run));
            }
            sum
        };
        assert_eq!(sum(&[1, 2, 3, 4]), sum(&[4, 2, 1, 3]));
        let one = sum(&[3]).over(&sum(&[3]), 2.0).unwrap();
        assert_eq!((one.value, one.interval), (0.5, None));
        assert_eq!(sum(&[3]).over(&sum(&[]), 1.0), None);
    }
}
