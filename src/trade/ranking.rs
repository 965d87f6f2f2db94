//! Whether a setting puts the programs into the same order as the reference.
use serde::{Deserialize, Serialize};

use crate::statistics::{Observation, compare};

/// Below this, two programs are ordered.
const SIGNIFICANT: f64 = 0.05;

/// Two programs, the one that the reference finds faster first where it finds one.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Ranked {
    /// Index of the first program.
    pub first: usize,
    /// Index of the second.
    pub second: usize,
    /// What the setting says to it.
    pub verdict: Verdict,
}

/// What a setting says about an order of the reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The reference itself shows no difference.
    Unordered,
    /// The same order, significantly.
    Kept,
    /// Its runs show no difference, or there are too few.
    Unclear,
    /// The other order, significantly: a wrong conclusion.
    Reversed,
}

/// Which of two samples is shorter on average.
#[derive(Clone, Copy, PartialEq)]
enum Order {
    First,
    Second,
    Unknown,
}

/// Holds the order of all pairs of programs against that of the reference.
pub fn rank(reference: &[Vec<Observation>], rung: &[Vec<Observation>]) -> Vec<Ranked> {
    let pairs = (0..reference.len()).flat_map(|i| (i + 1..reference.len()).map(move |j| (i, j)));
    let judge = |(i, j): (usize, usize)| {
        let truth = order(&reference[i], &reference[j]);
        let (first, second) = match truth {
            Order::Second => (j, i),
            _ => (i, j),
        };
        let verdict = match (truth, order(&rung[first], &rung[second])) {
            (Order::Unknown, _) => Verdict::Unordered,
            (_, Order::First) => Verdict::Kept,
            (_, Order::Second) => Verdict::Reversed,
            (_, Order::Unknown) => Verdict::Unclear,
        };
        Ranked {
            first,
            second,
            verdict,
        }
    };
    pairs.map(judge).collect()
}

fn order(first: &[Observation], second: &[Observation]) -> Order {
    match compare(first, second) {
        // The log-rank test may find curves different that have the same mean.
        Some(found) if found.p < SIGNIFICANT && found.difference.abs() > found.half_width => {
            if found.difference < 0.0 {
                Order::First
            } else {
                Order::Second
            }
        }
        _ => Order::Unknown,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around(mean: f64) -> Vec<Observation> {
        let spread = [-2.0, -1.0, 0.0, 1.0, 2.0];
        spread.map(|d| Observation::completed(mean + d)).to_vec()
    }

    fn verdicts(reference: [f64; 3], rung: [f64; 3]) -> Vec<(usize, usize, Verdict)> {
        let ranked = rank(&reference.map(around), &rung.map(around));
        ranked
            .iter()
            .map(|r| (r.first, r.second, r.verdict))
            .collect()
    }

    #[test]
    fn a_pair_is_kept_or_reversed_only_where_both_are_sure() {
        use Verdict::{Kept, Reversed, Unclear, Unordered};
        assert_eq!(
            verdicts([20.0, 10.0, 10.5], [30.0, 11.0, 12.0]),
            [(1, 0, Kept), (2, 0, Kept), (1, 2, Unordered)]
        );
        assert_eq!(
            verdicts([20.0, 10.0, 10.5], [10.0, 20.0, 10.5]),
            [(1, 0, Reversed), (2, 0, Unclear), (1, 2, Unordered)]
        );
    }

    #[test]
    fn a_program_that_was_not_run_is_unclear() {
        let reference = [around(10.0), around(20.0)];
        let ranked = rank(&reference, &[around(10.0), Vec::new()]);
        assert_eq!(ranked[0].verdict, Verdict::Unclear);
    }

    #[test]
    fn censored_runs_are_compared_as_curves() {
        let late = vec![Observation::censored(100.0); 8];
        let reference = [around(10.0), late.clone()];
        let ranked = rank(&reference, &[late, around(10.0)]);
        assert_eq!(ranked[0].verdict, Verdict::Reversed);
    }
}
