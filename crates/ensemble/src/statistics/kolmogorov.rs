//! How far two distributions are apart: the two-sample test of Kolmogorov and Smirnov.
use serde::{Deserialize, Serialize};

use super::{Observation, Status};

/// The distance of two samples, and whether chance explains it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Distance {
    /// The largest difference of the two shares of runs that have completed, 0 to 1.
    pub d: f64,
    /// Probability of at least this distance between samples of one continuous distribution; with
    /// tied or censored times it is an upper bound of that.
    pub p: f64,
    /// Where any time is censored: only times before this one, the first of them, are compared.
    pub horizon: Option<f64>,
}

/// Compares the distributions of two samples; `None`: one of them is empty.
///
/// A censored time says nothing about what comes after it, so that the two curves are compared up
/// to the first of either sample, where both are still exact. Of runs that never complete both are known for ever.
pub fn distance(first: &[Observation], second: &[Observation]) -> Option<Distance> {
    if first.is_empty() || second.is_empty() {
        return None;
    }
    let censored = first
        .iter()
        .chain(second)
        .filter(|o| o.status == Status::Censored);
    let horizon = censored.map(|o| o.time).min_by(f64::total_cmp);
    let known = |sample: &[Observation]| {
        let within = |time: f64| horizon.is_none_or(|horizon| time <= horizon);
        let times = sample.iter().filter(|o| o.is_completed() && within(o.time));
        let mut times: Vec<f64> = times.map(|o| o.time).collect();
        times.sort_by(f64::total_cmp);
        times
    };
    let (a, b) = (known(first), known(second));
    let (n, m) = (first.len() as u64, second.len() as u64);
    // In units of 1 / (n m), so that equal distances are equal.
    let (mut i, mut j, mut most) = (0, 0, 0);
    while i < a.len() || j < b.len() {
        let time = match (a.get(i), b.get(j)) {
            (Some(&x), Some(&y)) => x.min(y),
            (Some(&x), None) => x,
            (None, Some(&y)) => y,
            (None, None) => break,
        };
        i += a[i..].partition_point(|&x| x <= time);
        j += b[j..].partition_point(|&y| y <= time);
        most = most.max((i as u64 * m).abs_diff(j as u64 * n));
    }
    Some(Distance {
        d: most as f64 / (n * m) as f64,
        p: above(most, n, m),
        horizon,
    })
}

/// The probability that the distance is at least `most` / (n m).
fn above(most: u64, n: u64, m: u64) -> f64 {
    /// Up to here all orders are counted; beyond, the limit is as good.
    const COUNTED: u64 = 10_000_000;
    if n * m <= COUNTED {
        counted(most, n, m)
    } else {
        limit(most as f64 / ((n * m) as f64 * (n + m) as f64).sqrt())
    }
}

/// The share of all orders of n and m values in which the distance is reached.
///
/// J. L. Hodges, Arkiv för Matematik 3 (1958), 469-486: an order is a path on a lattice, and this is
/// the share of the paths to (i, j) that have touched the boundary.
fn counted(most: u64, n: u64, m: u64) -> f64 {
    let touches = |i: u64, j: u64| (i * m).abs_diff(j * n) >= most;
    let mut row: Vec<f64> = Vec::with_capacity(m as usize + 1);
    for i in 0..=n {
        for j in 0..=m {
            let share = if touches(i, j) {
                1.0
            } else {
                let total = (i + j) as f64;
                let below = if i > 0 {
                    row[j as usize] * i as f64
                } else {
                    0.0
                };
                let left = match j.checked_sub(1) {
                    Some(left) => row[left as usize] * j as f64,
                    None => 0.0,
                };
                if total > 0.0 {
                    (below + left) / total
                } else {
                    0.0
                }
            };
            match row.get_mut(j as usize) {
                Some(place) => *place = share,
                None => row.push(share),
            }
        }
    }
    row.last().copied().unwrap_or(1.0)
}

/// Kolmogorov's distribution above `x`, for large samples.
fn limit(x: f64) -> f64 {
    // Below this it is 1 to 12 digits, and the series would not end.
    if x < 0.2 {
        return 1.0;
    }
    let mut sum = 0.0;
    for k in 1..=100 {
        let term = (-2.0 * (f64::from(k) * x).powi(2)).exp();
        sum += if k % 2 == 1 { term } else { -term };
        if term < 1e-17 {
            break;
        }
    }
    (2.0 * sum).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn completed(times: &[f64]) -> Vec<Observation> {
        times.iter().copied().map(Observation::completed).collect()
    }

    const X: [f64; 8] = [
        2948.0, 6611.0, 5120.0, 7303.0, 14496.0, 4410.0, 3999.0, 6120.0,
    ];
    const Y: [f64; 6] = [2826.0, 5158.0, 4400.0, 5011.0, 8312.0, 4790.0];

    /// `scipy.stats.ks_2samp(x, y, method="exact")`, scipy 1.17.1.
    #[test]
    fn small_samples_agree_with_scipy() {
        let found = distance(&completed(&X), &completed(&Y)).unwrap();
        assert!((found.d - 0.3333333333333333).abs() < 1e-12, "{found:?}");
        assert!((found.p - 0.7838827838827839).abs() < 1e-12, "{found:?}");
        assert_eq!(found.horizon, None);
        let apart: Vec<f64> = X.iter().map(|x| x + 20_000.0).collect();
        let found = distance(&completed(&apart), &completed(&Y)).unwrap();
        // 2 of the C(14, 6) orders keep the samples apart.
        assert_eq!(found.d, 1.0);
        assert!((found.p - 2.0 / 3003.0).abs() < 1e-15);
    }

    /// `scipy.special.kolmogorov(x)`.
    #[test]
    fn the_limit_agrees_with_scipy() {
        for (x, p) in [
            (0.3, 0.9999906941986655),
            (0.8, 0.5441424115741981),
            (1.36, 0.049485876755377876),
            (2.5, 7.453306344157342e-06),
        ] {
            assert!((limit(x) / p - 1.0).abs() < 1e-12, "{x}: {}", limit(x));
        }
        assert_eq!(limit(0.0), 1.0);
    }

    /// `scipy.stats._stats_py._compute_outer_prob_inside_method(1000, 900, 100, most / 100)`.
    #[test]
    fn large_samples_agree_with_scipy() {
        for (most, p) in [
            (30000, 0.6534918895665078),
            (50000, 0.10280013145160045),
            (70000, 0.006083034383437147),
        ] {
            let counted = counted(most, 1000, 900);
            assert!((counted / p - 1.0).abs() < 1e-9, "{most}: {counted}");
        }
    }

    /// The error of the limit goes as the inverse root of the size.
    #[test]
    fn counting_comes_to_the_limit() {
        let gap = |n: u64| {
            let m = n * 9 / 10;
            let most = (1.4 * ((n * m) as f64 * (n + m) as f64).sqrt()) as u64;
            let x = most as f64 / ((n * m) as f64 * (n + m) as f64).sqrt();
            (counted(most, n, m) / limit(x) - 1.0).abs()
        };
        let gaps = [40, 400, 2000].map(gap);
        assert!(
            gaps[1] < 0.5 * gaps[0] && gaps[2] < 0.7 * gaps[1],
            "{gaps:?}"
        );
    }

    #[test]
    fn equal_samples_are_at_no_distance() {
        let found = distance(&completed(&X), &completed(&X)).unwrap();
        assert_eq!((found.d, found.p), (0.0, 1.0));
        assert_eq!(distance(&[], &completed(&X)), None);
    }

    #[test]
    fn what_comes_after_a_censored_time_is_not_compared() {
        let mut early = completed(&[1.0, 2.0, 3.0, 40.0, 50.0]);
        early.push(Observation::censored(10.0));
        let late = completed(&[1.5, 2.5, 3.5, 4.0, 5.0, 6.0]);
        let found = distance(&early, &late).unwrap();
        assert_eq!(found.horizon, Some(10.0));
        // Up to 10: three of six against six of six.
        assert_eq!(found.d, 0.5);
    }
}
