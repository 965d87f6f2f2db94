//! Convergence of the reference, judged by the changes when the substeps are doubled.
use serde::Serialize;

use crate::statistics::{Observation, Relative, Status, relative};

/// Number of last doublings that decide about convergence.
const STEPS: usize = 2;

/// Limit on a bias or change that counts as small. Its whole interval must be within the limit.
pub const CLOSE: f64 = 0.1;

/// Conclusion about whether the reference is close to the limit of small steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Convergence {
    /// The change by the last doubling is small, and its whole interval is within the limit. No
    /// change by the previous doubling is significant and possibly large.
    Converged,
    /// Undecided: the intervals are too wide, or there are fewer than two doublings.
    Undecided,
    /// Not converged: one of the last two doublings changed a mean significantly.
    NotConverged,
}

/// Change of the mean times when the number of substeps is doubled.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Doubling {
    /// Number of substeps before the doubling.
    pub from: u32,
    /// Number of substeps after the doubling.
    pub to: u32,
    /// For each program, the relative change of the mean time: mean after the doubling divided by
    /// mean before, minus one. `None` if a mean is unknown.
    pub changes: Vec<Option<Relative>>,
    /// For each program, the number of right-censored runs before and after the doubling. If the
    /// number is positive, the change is of restricted means.
    pub censored: Vec<usize>,
}

impl Doubling {
    /// Returns the changes between two numbers of substeps, each with the times of all programs.
    pub fn new<T: AsRef<[Observation]>>(from: (u32, &[T]), to: (u32, &[T])) -> Doubling {
        let programs = || to.1.iter().map(T::as_ref).zip(from.1.iter().map(T::as_ref));
        Doubling {
            from: from.0,
            to: to.0,
            changes: programs().map(|(to, from)| relative(to, from)).collect(),
            censored: programs()
                .map(|(to, from)| at_limit(to) + at_limit(from))
                .collect(),
        }
    }

    /// Returns whether the limit of ticks stopped any run.
    pub(super) fn is_cut(&self) -> bool {
        self.censored.iter().any(|&runs| runs > 0)
    }

    /// Returns the largest change of a mean that the intervals of these programs allow. Returns
    /// `None` if the intervals exclude nothing.
    pub fn bound(&self, programs: &[usize]) -> Option<f64> {
        let mut bounds = programs.iter().map(|&p| self.changes[p].as_ref()?.bound());
        bounds.try_fold(0.0, |most: f64, bound| Some(most.max(bound?)))
    }

    /// Returns whether the mean of any of these programs changed significantly by an amount that
    /// may exceed `within`.
    fn has_changed(&self, programs: &[usize], within: f64) -> bool {
        let changes = programs.iter().filter_map(|&p| self.changes[p].as_ref());
        let beyond = |change: &Relative| change.bound().is_some_and(|bound| bound > within);
        changes
            .into_iter()
            .any(|change| change.is_known() && beyond(change))
    }
}

/// Returns the number of runs that reached the limit of ticks.
pub(super) fn at_limit(times: &[Observation]) -> usize {
    let is_stopped = |run: &&Observation| run.status == Status::Censored;
    times.iter().filter(is_stopped).count()
}

/// Returns whether the means of these programs have converged, within the relative tolerance
/// `within`. For right-censored runs, these are restricted means.
pub fn convergence(doublings: &[Doubling], programs: &[usize], within: f64) -> Convergence {
    let last = &doublings[doublings.len().saturating_sub(STEPS)..];
    if last.iter().any(|it| it.has_changed(programs, within)) {
        return Convergence::NotConverged;
    }
    let bound = last.last().and_then(|it| it.bound(programs));
    if bound.is_some_and(|bound| bound <= within) && last.len() == STEPS {
        Convergence::Converged
    } else {
        Convergence::Undecided
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn around(mean: f64) -> Vec<Observation> {
        let spread = [-2.0, -1.0, 0.0, 1.0, 2.0];
        spread.map(|d| Observation::completed(mean + d)).to_vec()
    }

    fn doublings(means: &[f64]) -> Vec<Doubling> {
        let pairs = means.windows(2).zip(0..);
        let of = |(pair, k): (&[f64], u32)| {
            let [from, to] = [pair[0], pair[1]].map(|mean| vec![around(50.0), around(mean)]);
            Doubling::new((1 << k, &from), (2 << k, &to))
        };
        pairs.map(of).collect()
    }

    #[test]
    fn convergence_is_a_statement_about_intervals() {
        use Convergence::{Converged, NotConverged, Undecided};
        let found = |means: &[f64], within| convergence(&doublings(means), &[0, 1], within);
        assert_eq!(found(&[100.0, 100.5], CLOSE), Undecided, "only one");
        assert_eq!(found(&[100.0, 100.5, 100.0], CLOSE), Converged);
        // The intervals are 2.3 % and, for the first program, 4.6 %.
        assert_eq!(found(&[100.0, 100.5, 100.0], 0.03), Undecided);
        assert_eq!(
            convergence(&doublings(&[100.0, 100.5, 100.0]), &[1], 0.03),
            Converged
        );
        assert_eq!(found(&[100.0, 115.0, 115.0], CLOSE), NotConverged);
        // The change is significant, but small.
        assert_eq!(found(&[100.0, 104.0, 104.0], CLOSE), Converged);
        assert_eq!(found(&[100.0, 100.0, 104.0], 0.05), NotConverged);
    }

    #[test]
    fn without_an_interval_nothing_has_converged() {
        let one = vec![vec![Observation::completed(5.0)]];
        let doubling = Doubling::new((1, &one), (2, &one));
        assert_eq!(doubling.bound(&[0]), None);
        let many = vec![doubling; 3];
        assert_eq!(convergence(&many, &[0], CLOSE), Convergence::Undecided);
        let known = doublings(&[100.0, 100.0])[0].bound(&[0, 1]).unwrap();
        assert!(known > 0.02 && known < 0.06);
    }

    proptest! {
        #[test]
        fn a_wide_interval_has_not_converged(
            changes in proptest::collection::vec((-0.6_f64..0.6, 0.0_f64..0.6), 2..8),
            within in 0.01_f64..0.3,
        ) {
            let doublings: Vec<Doubling> = changes
                .iter()
                .map(|&(value, half)| Doubling {
                    from: 1,
                    to: 2,
                    changes: vec![Some(Relative { value, half_width: Some(half), horizon: None })],
                    censored: vec![0],
                })
                .collect();
            let last = changes[changes.len() - 1];
            let before = changes[changes.len() - 2];
            let is_known = |(value, half): (f64, f64)| value.abs() > half;
            let is_large = |(value, half): (f64, f64)| value.abs() + half > within;
            match convergence(&doublings, &[0], within) {
                Convergence::Converged => {
                    prop_assert!(!is_large(last));
                    prop_assert!(!(is_known(before) && is_large(before)));
                }
                Convergence::NotConverged => {
                    prop_assert!([last, before].iter().any(|&it| is_known(it) && is_large(it)));
                }
                Convergence::Undecided => {
                    prop_assert!(is_large(last));
                    prop_assert!(![last, before].iter().any(|&it| is_known(it) && is_large(it)));
                }
            }
        }
    }
}
