//! Convolution of probability distributions on whole numbers.
use std::f64::consts::PI;

use nalgebra::Complex;

/// Bound of the sum of all errors of a [`convolution`] with at most 2^20 terms. It includes the part
/// that is cut off.
const ERROR: f64 = 2e-11;

/// Largest sum of the last probabilities of a distribution that are cut off.
const NEGLIGIBLE: f64 = 1e-11;

/// Distribution of a sum of independent whole numbers.
#[derive(Debug)]
pub(crate) struct SumDistribution {
    /// Number of probabilities to compute.
    terms: usize,
    /// Distributions of partial sums with their numbers of summands. These numbers are falling
    /// powers of two, so that the factors of most convolutions are short.
    parts: Vec<(u32, Vec<f64>)>,
    convolutions: u32,
}

impl SumDistribution {
    /// Returns the distribution of the empty sum, for the numbers up to `terms - 1`.
    pub fn new(terms: usize) -> SumDistribution {
        SumDistribution {
            terms,
            parts: Vec::new(),
            convolutions: 0,
        }
    }

    /// Adds a summand. Element k of `distribution` is the probability of k.
    pub fn add(&mut self, distribution: Vec<f64>) {
        self.parts.push((1, distribution));
        while let [.., (before, _), (last, _)] = self.parts[..]
            && before == last
        {
            self.join();
        }
    }

    /// Replaces the last two parts by their sum.
    fn join(&mut self) {
        if let Some((count, one)) = self.parts.pop()
            && let Some((before, other)) = self.parts.pop()
        {
            let sum = convolution(&one, &other, self.terms);
            self.parts.push((before + count, without_tail(sum)));
            self.convolutions += 1;
        }
    }

    /// Returns a bound of the error of each sum of probabilities.
    pub fn error(&self) -> f64 {
        let open = self.parts.len().saturating_sub(1) as u32;
        ERROR * f64::from(self.convolutions + open)
    }

    /// Returns the probabilities of 0, 1, 2 and so on. The last ones can be missing.
    pub fn finish(mut self) -> Vec<f64> {
        while self.parts.len() > 1 {
            self.join();
        }
        self.parts.pop().map_or_else(|| vec![1.0], |(_, sum)| sum)
    }
}

/// Removes the last probabilities of a distribution, as long as they are negligible together.
fn without_tail(mut distribution: Vec<f64>) -> Vec<f64> {
    let mut tail = 0.0;
    let last = distribution.iter().rposition(|probability| {
        tail += probability;
        tail > NEGLIGIBLE
    });
    distribution.truncate(last.map_or(0, |last| last + 1));
    distribution
}

/// Returns the distribution of the sum of two independent numbers, up to `terms - 1`. Element k of
/// each distribution is the probability of k.
fn convolution(one: &[f64], other: &[f64], terms: usize) -> Vec<f64> {
    let [one, other] = [one, other].map(|it| &it[..it.len().min(terms)]);
    // Shorter transforms would add the end of the sum to its start.
    let length = (one.len() + other.len()).next_power_of_two();
    let [mut product, other] = [one, other].map(|probabilities| {
        let values = probabilities.iter().map(|&it| Complex::new(it, 0.0));
        let mut values: Vec<_> = values.collect();
        values.resize(length, Complex::default());
        transform(&mut values, -1.0);
        values
    });
    for (value, other) in product.iter_mut().zip(other) {
        *value *= other;
    }
    transform(&mut product, 1.0);
    product.truncate(terms);
    let scaled = product.into_iter().map(|it| it.re / length as f64);
    scaled.map(|it| it.max(0.0)).collect()
}

/// Replaces values by their discrete Fourier transform without scaling. Their number is a power of
/// two. `sign` is the sign of the exponent.
///
/// # Source
///
/// J. W. Cooley and J. W. Tukey, Mathematics of Computation 19 (1965), 297-301.
fn transform(values: &mut [Complex<f64>], sign: f64) {
    let length = values.len();
    let bits = length.trailing_zeros();
    for i in 1..length {
        let reversed = i.reverse_bits() >> (usize::BITS - bits);
        if i < reversed {
            values.swap(i, reversed);
        }
    }
    let mut half = 1;
    while half < length {
        let turns: Vec<_> = (0..half)
            .map(|k| {
                let (sin, cos) = libm::sincos(sign * PI * k as f64 / half as f64);
                Complex::new(cos, sin)
            })
            .collect();
        for block in values.chunks_mut(2 * half) {
            let (even, odd) = block.split_at_mut(half);
            for ((even, odd), turn) in even.iter_mut().zip(odd).zip(&turns) {
                let turned = *odd * turn;
                (*even, *odd) = (*even + turned, *even - turned);
            }
        }
        half *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_dice_have_known_probabilities() {
        let die = [0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0].map(|it| it / 6.0);
        let two = convolution(&die, &die, 13);
        for (sum, ways) in [0, 0, 1, 2, 3, 4, 5, 6, 5, 4, 3, 2, 1]
            .into_iter()
            .enumerate()
        {
            assert!((two[sum] - f64::from(ways) / 36.0).abs() < 1e-15, "{two:?}");
        }
        assert_eq!(convolution(&die, &die, 5).len(), 5);
        assert!((convolution(&die, &die, 5)[4] - 3.0 / 36.0).abs() < 1e-15);
    }

    #[test]
    fn long_sums_agree_with_the_definition() {
        let one: Vec<f64> = (0..300).map(|k| f64::from(k % 7) / 900.0).collect();
        let other: Vec<f64> = (0..500).map(|k| f64::from(k % 11) / 2500.0).collect();
        let sum = convolution(&one, &other, 799);
        for at in [0, 1, 250, 499, 640, 798] {
            let terms = (0..=at).filter_map(|k| Some(one.get(k)? * other.get(at - k)?));
            assert!((sum[at] - terms.sum::<f64>()).abs() < 1e-14, "{at}");
        }
    }

    /// The number of failures before the n-th success has a negative binomial distribution.
    #[test]
    fn errors_of_long_sums_are_within_their_bound() {
        let (summands, success, terms) = (5_u32, 1e-3_f64, 100_000);
        let failures: Vec<f64> = (0..terms)
            .map(|k| success * ((-success).ln_1p() * k as f64).exp())
            .collect();
        let mut sum = SumDistribution::new(terms);
        for _ in 0..summands {
            sum.add(failures.clone());
        }
        let bound = sum.error();
        assert!((bound / (4.0 * ERROR) - 1.0).abs() < 1e-9);
        let sum = sum.finish();
        let mut known = success.powi(summands as i32);
        let (mut error, mut all) = (0.0, 0.0);
        for k in 0..terms {
            error += (sum.get(k).unwrap_or(&0.0) - known).abs();
            all += known;
            known *= (1.0 - success) * (k as f64 + f64::from(summands)) / (k as f64 + 1.0);
        }
        assert!(all > 0.999, "{all}");
        assert!(error < bound, "{error}");
    }
}
