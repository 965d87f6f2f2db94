//! Posterior of parameters by sequential Monte Carlo.
//!
//! # Source
//!
//! P. Del Moral and others, J. R. Stat. Soc. B 68, 411 (2006).
use nalgebra::{DMatrix, DVector};
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use super::Prior;
use super::simulated::is_within;
use crate::statistics::quantile;

/// Number of draws from the posterior distribution.
const DRAWS: usize = 4_000;

/// Number of Metropolis steps of each draw at each power of the likelihood.
const MOVES: usize = 12;

/// Smallest width of a box, as a fraction of the prior. Narrower boxes do not allow fitting a
/// polynomial.
const MIN: f64 = 0.1;

/// Draws from a posterior distribution. Each coordinate is a cumulative probability of the prior of
/// one parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Posterior {
    /// Draws. Each is a list of coordinates.
    pub draws: Vec<Vec<f64>>,
}

/// Marginal posterior distribution of one parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Marginal {
    /// Name of the parameter.
    pub name: String,
    /// Unit of the values. Empty if the parameter has no unit.
    pub unit: String,
    /// Median of the posterior.
    pub median: f64,
    /// 95 % interval of the parameter, in `unit`.
    pub interval: (f64, f64),
    /// Width of the interval, as a fraction of the prior's width. If it is near 1, the data do not
    /// constrain the parameter.
    pub width: f64,
    /// Whether the posterior is concentrated at an end of the prior. The true value may then be
    /// outside.
    pub is_at_edge: bool,
}

impl Posterior {
    /// Draws from a posterior. The prior is uniform in a box with these lower and upper ends. Equal
    /// seeds give equal draws.
    ///
    /// The likelihood is introduced in steps. Each step keeps half of the draws effective.
    pub fn sample(
        ends: &[(f64, f64)],
        log_likelihood: impl Fn(&[f64]) -> f64,
        seed: u64,
    ) -> Posterior {
        let numbers = ends.len();
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut draw = || {
            let within = ends
                .iter()
                .map(|(low, high)| low + (high - low) * random.random::<f64>());
            within.collect::<Vec<f64>>()
        };
        let mut draws: Vec<Vec<f64>> = (0..DRAWS).map(|_| draw()).collect();
        let mut known: Vec<f64> = draws.iter().map(|draw| log_likelihood(draw)).collect();
        let mut heat = 0.0;
        while heat < 1.0 {
            let next = next_temperature(&known, heat);
            let chosen = resample(&weights(&known, next - heat), random.random());
            draws = chosen.iter().map(|&i| draws[i].clone()).collect();
            known = chosen.iter().map(|&i| known[i]).collect();
            heat = next;
            let step = step(&draws);
            for (draw, known) in draws.iter_mut().zip(&mut known) {
                for _ in 0..MOVES {
                    let kick =
                        DVector::from_iterator(numbers, (0..numbers).map(|_| normal(&mut random)));
                    let kick = &step * kick;
                    let moved: Vec<f64> =
                        draw.iter().zip(kick.iter()).map(|(x, by)| x + by).collect();
                    let chance: f64 = random.random();
                    if !is_within(&moved, ends) {
                        continue;
                    }
                    let there = log_likelihood(&moved);
                    if chance.ln() < heat * (there - *known) {
                        (*draw, *known) = (moved, there);
                    }
                }
            }
        }
        Posterior { draws }
    }

    /// Returns the marginal posterior of parameter `i`, whose prior is given.
    pub fn marginal(&self, i: usize, prior: &Prior) -> Marginal {
        let shares: Vec<f64> = self.draws.iter().map(|draw| draw[i]).collect();
        let at = |share| quantile(&shares, share).unwrap_or(0.5);
        let (low, high) = (at(0.025), at(0.975));
        let near = |end: f64| {
            shares
                .iter()
                .filter(|share| (*share - end).abs() < MIN)
                .count()
        };
        // A uniform distribution has a tenth of its draws at each end. Three times this number
        // indicates an edge.
        let is_crowded = |end| near(end) as f64 > 3.0 * MIN * shares.len() as f64;
        let (low, high) = prior.outward((low, high));
        Marginal {
            name: prior.name.clone(),
            unit: prior.unit.clone(),
            median: prior.value(prior.possible(at(0.5))),
            interval: (prior.value(low), prior.value(high)),
            width: ((high - low) / 0.95).min(1.0),
            is_at_edge: is_crowded(0.0) || is_crowded(1.0),
        }
    }

    /// Returns a box for the next design. It contains nearly all draws, with a margin.
    pub fn surroundings(&self) -> Vec<(f64, f64)> {
        let numbers = self.draws.first().map_or(0, Vec::len);
        let ends = |i: usize| {
            let shares: Vec<f64> = self.draws.iter().map(|draw| draw[i]).collect();
            let at = |share| quantile(&shares, share).unwrap_or(0.5);
            let (low, high) = (at(0.005), at(0.995));
            let room = (0.25 * (high - low)).max((MIN - (high - low)) / 2.0);
            ((low - room).max(0.0), (high + room).min(1.0))
        };
        (0..numbers).map(ends).collect()
    }
}

/// Returns the normalized weights of draws for the likelihood raised to `power`.
fn weights(known: &[f64], power: f64) -> Vec<f64> {
    let most = known.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weights = known.iter().map(|it| (power * (it - most)).exp());
    let weights: Vec<f64> = weights
        .map(|it| if it.is_finite() { it } else { 0.0 })
        .collect();
    let sum: f64 = weights.iter().sum();
    weights.iter().map(|it| it / sum).collect()
}

/// Returns the power of the likelihood for the next step, at most 1. With this power, at least half
/// of the draws stay effective.
fn next_temperature(known: &[f64], heat: f64) -> f64 {
    let of_use = |power: f64| {
        let squares: f64 = weights(known, power - heat).iter().map(|it| it * it).sum();
        1.0 / squares
    };
    let enough = known.len() as f64 / 2.0;
    if of_use(1.0) >= enough {
        return 1.0;
    }
    let (mut low, mut high) = (heat, 1.0);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if of_use(middle) >= enough {
            low = middle
        } else {
            high = middle
        }
    }
    // The power must increase strictly in spite of rounding.
    low.max(heat + 1e-12).min(1.0)
}

/// Returns indices of draws, selected by weight (systematic resampling).
fn resample(weights: &[f64], offset: f64) -> Vec<usize> {
    let n = weights.len();
    let (mut sum, mut i) = (weights[0], 0);
    (0..n)
        .map(|k| {
            let at = (k as f64 + offset) / n as f64;
            while sum < at && i + 1 < n {
                i += 1;
                sum += weights[i];
            }
            i
        })
        .collect()
}

/// Returns a matrix that converts independent normal random numbers into random steps of suitable
/// size between draws.
fn step(draws: &[Vec<f64>]) -> DMatrix<f64> {
    let numbers = draws[0].len();
    let n = draws.len() as f64;
    let rows = draws.iter().map(|draw| DVector::from_column_slice(draw));
    let rows: Vec<DVector<f64>> = rows.collect();
    let middle = rows.iter().sum::<DVector<f64>>() / n;
    let mut covariance = DMatrix::zeros(numbers, numbers);
    for row in &rows {
        covariance += (row - &middle) * (row - &middle).transpose() / n;
    }
    for i in 0..numbers {
        covariance[(i, i)] += 1e-10;
    }
    let size = 2.38 / (numbers as f64).sqrt();
    covariance.cholesky().map_or_else(
        || DMatrix::identity(numbers, numbers) * 1e-3,
        |factor| factor.l() * size,
    )
}

/// Returns a random number from the standard normal distribution (G. E. P. Box and M. E. Muller,
/// 1958).
fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (a, b): (f64, f64) = (random.random(), random.random());
    (-2.0 * (1.0 - a).ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn prior(of: &str) -> Prior {
        Prior::parse(&format!("{of}=0..1")).unwrap()
    }

    #[test]
    fn a_normal_likelihood_gives_a_normal_posterior() {
        let (at, sd) = ([0.4, 0.6, 0.5], [0.05, 0.01, 0.1]);
        let likelihood = |x: &[f64]| {
            let off = (0..3).map(|i| ((x[i] - at[i]) / sd[i]).powi(2));
            -0.5 * off.sum::<f64>()
        };
        let posterior = Posterior::sample(&[(0.0, 1.0); 3], likelihood, 1);
        assert_eq!(
            posterior,
            Posterior::sample(&[(0.0, 1.0); 3], likelihood, 1)
        );
        for i in 0..3 {
            let found = posterior.marginal(i, &prior("x"));
            let half = (found.interval.1 - found.interval.0) / 2.0;
            assert!((found.median - at[i]).abs() < 0.1 * sd[i], "{found:?}");
            assert!((half / (1.96 * sd[i]) - 1.0).abs() < 0.1, "{found:?}");
            assert!(!found.is_at_edge);
        }
    }

    #[test]
    fn unconstrained_parameters_keep_their_prior() {
        let likelihood = |x: &[f64]| -0.5 * ((x[0] + 0.2) / 0.1).powi(2);
        let posterior = Posterior::sample(&[(0.0, 1.0); 2], likelihood, 1);
        let [first, second] = [0, 1].map(|i| posterior.marginal(i, &prior("x")));
        assert!(first.is_at_edge && first.width < 0.2, "{first:?}");
        assert!(
            (second.width - 1.0).abs() < 0.05 && !second.is_at_edge,
            "{second:?}"
        );
        let ends = posterior.surroundings();
        assert!(ends[0].1 < 0.4 && ends[1] == (0.0, 1.0), "{ends:?}");
    }
}
