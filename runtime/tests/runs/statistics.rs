//! Statistical tests of whether two samples have the same distribution.
use std::f64::consts::SQRT_2;

/// Returns a mean and the half-width of its 95 % confidence interval.
pub fn mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let square = |x: &f64| (x - mean).powi(2);
    let variance = values.iter().map(square).sum::<f64>() / (n - 1.0);
    (mean, 1.96 * (variance / n).sqrt())
}

/// Returns the greatest distance between the empirical distributions of two samples.
pub fn gap(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (sorted(a), sorted(b));
    let below = |of: &[f64], x: f64| of.partition_point(|&y| y <= x) as f64 / of.len() as f64;
    a.iter()
        .chain(&b)
        .map(|&x| (below(&a, x) - below(&b, x)).abs())
        .fold(0.0, f64::max)
}

/// Returns the p-value of the Kolmogorov-Smirnov test for two samples (asymptotic, with Stephens'
/// correction for finite samples).
pub fn kolmogorov_smirnov(a: &[f64], b: &[f64]) -> f64 {
    let n = (a.len() * b.len()) as f64 / (a.len() + b.len()) as f64;
    let x = (n.sqrt() + 0.12 + 0.11 / n.sqrt()) * gap(a, b);
    if x < 0.2 {
        return 1.0;
    }
    let term = |k: i32| {
        let sign = if k % 2 == 1 { 2.0 } else { -2.0 };
        sign * (-2.0 * f64::from(k * k) * x * x).exp()
    };
    (1..=100).map(term).sum::<f64>().clamp(0.0, 1.0)
}

/// Returns the p-value of the Mann-Whitney test for two samples (normal approximation, with ties).
pub fn mann_whitney(a: &[f64], b: &[f64]) -> f64 {
    let (n, m) = (a.len() as f64, b.len() as f64);
    let mut all: Vec<(f64, bool)> = a.iter().map(|&x| (x, true)).collect();
    all.extend(b.iter().map(|&x| (x, false)));
    all.sort_by(|x, y| x.0.total_cmp(&y.0));
    let (mut ranks, mut ties, mut before) = (0.0, 0.0, 0.0);
    for same in all.chunk_by(|x, y| x.0 == y.0) {
        let count = same.len() as f64;
        let rank = before + (count + 1.0) / 2.0;
        ranks += rank * same.iter().filter(|x| x.1).count() as f64;
        ties += count.powi(3) - count;
        before += count;
    }
    let excess = ranks - n * (n + 1.0) / 2.0 - n * m / 2.0;
    let all = n + m;
    let variance = n * m / 12.0 * (all + 1.0 - ties / (all * (all - 1.0)));
    if variance == 0.0 {
        return 1.0;
    }
    libm::erfc(excess.abs() / variance.sqrt() / SQRT_2)
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values
}
