//! Whether the reference has converged: what doubling the substeps still changes.
use serde::{Deserialize, Serialize};

use crate::statistics::{Observation, Relative, relative};

/// How many doublings in a row have to change nothing.
pub const STEPS: usize = 2;

/// What changes when the substeps are doubled.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Doubling {
    /// Substeps before.
    pub from: u32,
    /// Substeps after.
    pub to: u32,
    /// For each program, the mean after over the mean before, less one; `None`: nothing to compare.
    pub changes: Vec<Option<Relative>>,
}

impl Doubling {
    /// Compares the times of each program before and after.
    pub fn of(from: (u32, &[Vec<Observation>]), to: (u32, &[Vec<Observation>])) -> Doubling {
        let programs = to.1.iter().zip(from.1);
        Doubling {
            from: from.0,
            to: to.0,
            changes: programs.map(|(to, from)| relative(to, from)).collect(),
        }
    }

    /// Whether no mean has changed by more than its interval.
    pub fn settled(&self) -> bool {
        self.changes.iter().all(|change| match change {
            Some(Relative {
                value,
                half_width: Some(half_width),
            }) => value.abs() <= *half_width,
            _ => false,
        })
    }

    /// The largest change that the intervals do not exclude; `None`: nothing is excluded.
    pub fn bound(&self) -> Option<f64> {
        let mut bounds = self.changes.iter().map(|change| change.as_ref()?.bound());
        bounds.try_fold(0.0, |most: f64, bound| Some(most.max(bound?)))
    }
}

/// Whether the last doublings have changed nothing.
pub fn converged(doublings: &[Doubling]) -> bool {
    let last = doublings.len().checked_sub(STEPS);
    last.is_some_and(|first| doublings[first..].iter().all(Doubling::settled))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn around(mean: f64) -> Vec<Observation> {
        let spread = [-2.0, -1.0, 0.0, 1.0, 2.0];
        spread.map(|d| Observation::completed(mean + d)).to_vec()
    }

    fn doublings(means: &[f64]) -> Vec<Doubling> {
        let pairs = means.windows(2).zip(0..);
        let of = |(pair, k): (&[f64], u32)| {
            let [from, to] = [pair[0], pair[1]].map(|mean| vec![around(50.0), around(mean)]);
            Doubling::of((1 << k, &from), (2 << k, &to))
        };
        pairs.map(of).collect()
    }

    #[test]
    fn two_doublings_in_a_row_have_to_change_nothing() {
        assert!(!converged(&doublings(&[100.0, 100.5])), "only one");
        assert!(converged(&doublings(&[100.0, 100.5, 100.0])));
        assert!(!converged(&doublings(&[100.0, 110.0, 110.0])));
        assert!(!converged(&doublings(&[100.0, 100.0, 110.0])));
        assert!(converged(&doublings(&[100.0, 120.0, 119.5, 120.0])));
    }

    #[test]
    fn where_there_is_no_interval_nothing_has_settled() {
        let one = vec![vec![Observation::completed(5.0)]];
        let doubling = Doubling::of((1, &one), (2, &one));
        assert!(!doubling.settled());
        assert_eq!(doubling.bound(), None);
        let known = &doublings(&[100.0, 100.0])[0];
        assert!(known.bound().unwrap() > 0.02 && known.bound().unwrap() < 0.06);
    }
}
