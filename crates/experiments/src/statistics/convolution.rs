//! Convolution of probability distributions on whole numbers.
use std::f64::consts::PI;

use nalgebra::Complex;

/// Returns the distribution of the sum of two independent numbers, up to `terms - 1`. Element k of
/// each distribution is the probability of k.
///
/// The absolute error of each probability is below 1e-12.
pub(crate) fn convolution(one: &[f64], other: &[f64], terms: usize) -> Vec<f64> {
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
    use super::convolution;

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
}
