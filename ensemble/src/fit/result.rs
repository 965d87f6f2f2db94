//! What came of a fit.
use serde::Serialize;

use super::data::{Observed, Unit};
use super::emulator::Emulator;
use super::posterior::{Marginal, Posterior};
use super::prior::Prior;
use crate::statistics::quantile;

/// Numbers of a scene that data speak for.
#[derive(Clone, Debug, Serialize)]
pub struct Fit {
    /// The unit of all times.
    pub unit: Unit,
    /// One for each number, in the order of the priors.
    pub numbers: Vec<Marginal>,
    /// Correlations of the numbers in the posterior.
    pub correlations: Vec<Vec<f64>>,
    /// One for each program that was measured.
    pub predictions: Vec<Prediction>,
    /// Points simulated, of all rounds.
    pub points: usize,
    /// Runs made at them.
    pub runs: usize,
    /// Runs that were stopped before they completed, which no figure counts.
    pub stopped: usize,
    /// Draws from the posterior, in the units of the priors.
    pub draws: Vec<Vec<f64>>,
}

/// The times of a program as the posterior predicts them for a new measurement of the same size.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Prediction {
    /// What was measured.
    pub observed: Observed,
    /// Whether the fit has used it; `false`: it was held out.
    pub is_fitted: bool,
    /// Median of the predicted mean.
    pub mean: f64,
    /// 95 % interval of the predicted mean.
    pub mean_interval: (f64, f64),
    /// Median of the predicted standard deviation.
    pub sd: f64,
    /// 95 % interval of the predicted standard deviation.
    pub sd_interval: (f64, f64),
}

impl Prediction {
    /// Whether the measured mean is within its interval.
    pub fn has_mean(&self) -> bool {
        (self.mean_interval.0..=self.mean_interval.1).contains(&self.observed.mean)
    }

    /// Whether the measured standard deviation is within its interval.
    pub fn has_sd(&self) -> bool {
        (self.sd_interval.0..=self.sd_interval.1).contains(&self.observed.sd)
    }
}

/// A program that was measured, with its emulator.
pub struct FittedProgram<'a> {
    /// What was measured.
    pub observed: &'a Observed,
    /// Whether the fit uses it.
    pub is_fitted: bool,
    /// What simulations say of it.
    pub emulator: &'a Emulator,
}

impl Posterior {
    /// The posterior of numbers by the programs that are fitted, within the box that their emulators are of: beyond it these know
    /// so little that anything might be there.
    pub fn of(ends: &[(f64, f64)], programs: &[FittedProgram], seed: u64) -> Posterior {
        let fitted = || programs.iter().filter(|program| program.is_fitted);
        let likelihood = |at: &[f64]| {
            let of = |program: &FittedProgram| {
                let Observed { n, mean, sd, .. } = *program.observed;
                program.emulator.log_likelihood(at, n, mean, sd)
            };
            fitted().map(of).sum()
        };
        Posterior::sample(ends, likelihood, seed)
    }

    /// What it predicts for a measurement like the one of a program.
    pub fn predict(&self, program: &FittedProgram) -> Prediction {
        let chance = program.emulator.sampling_variance(program.observed.n);
        let spread = |which: usize| {
            let draws = self.draws.iter().enumerate();
            let values: Vec<f64> = draws
                .map(|(i, draw)| {
                    let estimate = program.emulator.estimate(draw);
                    let sd = (estimate.variance[which] + chance[which]).sqrt();
                    // Errors evenly spread over the draws, by a sequence without chance.
                    let share = (i as f64 * 0.618_033_988_749_894_9 + 0.5).fract();
                    estimate.of[which] + sd * normal_at(share)
                })
                .collect();
            let at = |share| quantile(&values, share).unwrap_or(f64::NAN).exp();
            (at(0.5), (at(0.025), at(0.975)))
        };
        let ((mean, mean_interval), (sd, sd_interval)) = (spread(0), spread(1));
        Prediction {
            observed: program.observed.clone(),
            is_fitted: program.is_fitted,
            mean,
            mean_interval,
            sd,
            sd_interval,
        }
    }

    /// Correlations of all numbers.
    pub fn correlations(&self) -> Vec<Vec<f64>> {
        let numbers = self.draws.first().map_or(0, Vec::len);
        let n = self.draws.len() as f64;
        let mean = |i: usize| self.draws.iter().map(|draw| draw[i]).sum::<f64>() / n;
        let means: Vec<f64> = (0..numbers).map(mean).collect();
        let product = |i: usize, j: usize| {
            let each = self
                .draws
                .iter()
                .map(|draw| (draw[i] - means[i]) * (draw[j] - means[j]));
            each.sum::<f64>() / n
        };
        let row = |i| {
            let of = |j| product(i, j) / (product(i, i) * product(j, j)).sqrt();
            (0..numbers).map(of).collect()
        };
        (0..numbers).map(row).collect()
    }

    /// The draws in the units of the priors.
    pub fn values(&self, priors: &[Prior]) -> Vec<Vec<f64>> {
        let value = |draw: &Vec<f64>| {
            let pairs = draw.iter().zip(priors);
            pairs.map(|(share, prior)| prior.value(*share)).collect()
        };
        self.draws.iter().map(value).collect()
    }
}

fn normal_at(share: f64) -> f64 {
    use statrs::distribution::{ContinuousCDF as _, Normal};
    Normal::standard().inverse_cdf(share.clamp(1e-9, 1.0 - 1e-9))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::super::{Design, Simulated};
    use super::*;
    use crate::statistics::Summary;

    /// Sums of four waits, with the mean that a law of two numbers has.
    fn times(random: &mut ChaCha8Rng, at: &[f64], n: usize) -> Vec<f64> {
        let mean = (6.0 - 1.2 * at[0] + 0.4 * at[1] * at[0]).exp();
        let wait = |random: &mut ChaCha8Rng| -(1.0 - random.random::<f64>()).ln() * mean / 4.0;
        (0..n).map(|_| (0..4).map(|_| wait(random)).sum()).collect()
    }

    /// Two rounds of a fit of the first number of the law to what was measured there.
    fn fitted(random: &mut ChaCha8Rng, truth: &[f64], seed: u64) -> (Marginal, Prediction) {
        let measured = Summary::of(&times(random, truth, 100)).unwrap();
        let observed = Observed {
            program: "sums".to_owned(),
            n: measured.n,
            mean: measured.mean,
            sd: measured.sd.unwrap(),
        };
        let mut ends = vec![(0.0, 1.0); 2];
        let mut points: Vec<Simulated> = Vec::new();
        let mut found = None;
        for round in 0..2 {
            let design = Design::latin_hypercube(&ends, 18, seed + 1000 * round);
            points.extend(design.points.into_iter().map(|at| Simulated {
                times: times(random, &at, 12),
                at,
            }));
            let near = points.iter().filter(|point| point.is_within(&ends));
            let near: Vec<Simulated> = near.cloned().collect();
            let emulator = Emulator::of(&near).unwrap();
            let measured = FittedProgram {
                observed: &observed,
                is_fitted: true,
                emulator: &emulator,
            };
            let posterior = Posterior::of(&ends, std::slice::from_ref(&measured), seed);
            ends = posterior.surroundings();
            let prior = Prior::parse("x=0..1").unwrap();
            found = Some((posterior.marginal(0, &prior), posterior.predict(&measured)));
        }
        found.unwrap()
    }

    /// An interval of 95 % holds the truth about so often.
    #[test]
    fn intervals_hold_what_they_promise() {
        const TRIALS: u64 = 60;
        let (mut held, mut widths) = (0, 0.0);
        for trial in 0..TRIALS {
            let mut random = ChaCha8Rng::seed_from_u64(trial);
            let truth = [0.2 + 0.6 * random.random::<f64>(), 0.5];
            let (low, high) = fitted(&mut random, &truth, trial).0.interval;
            held += u64::from((low..=high).contains(&truth[0]));
            widths += high - low;
        }
        println!("{held} of {TRIALS}, mean width {}", widths / TRIALS as f64);
        // Binomial: 52 or fewer of 60 have a probability of 1 %.
        assert!(held >= 52, "{held} of {TRIALS}");
        assert!(widths / (TRIALS as f64) < 0.5, "the data say something");
    }

    /// What nothing in the range explains is missed, and most often found at the end that is nearest.
    #[test]
    fn a_truth_beyond_the_range_is_told() {
        let mut at_end = 0;
        for trial in 0..20 {
            let beyond = [2.5, -1.5][trial as usize % 2];
            let mut random = ChaCha8Rng::seed_from_u64(100 + trial);
            let (found, predicted) = fitted(&mut random, &[beyond, 0.5], trial);
            assert!(!predicted.has_mean(), "{trial}: {predicted:?}");
            let end = f64::from(beyond > 0.0);
            at_end += u32::from(found.is_at_edge && (found.median - end).abs() < 0.1);
        }
        println!("{at_end} of 20");
        assert!(at_end >= 15, "{at_end} of 20");
    }
}
