//! Whether a setting puts the programs into the same order as the reference.
use serde::{Deserialize, Serialize};

use crate::statistics::{Longer, Runs};
use crate::{ComparedProgram, PairwiseResult as Known, pairwise_tests};

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
    /// The reference itself leaves the order undecided.
    Unordered,
    /// The same order, significantly.
    Kept,
    /// Its runs leave the order undecided.
    Unclear,
    /// The other order, significantly: a wrong conclusion.
    Reversed,
}

/// Holds the order of all pairs of programs against that of the reference.
///
/// Both are judged as everywhere: run by run, corrected for the number of pairs.
pub fn rank(reference: &[Runs], candidate: &[Runs]) -> Vec<Ranked> {
    let rank_pair =
        |((i, j, truth), (_, _, found)): ((usize, usize, Longer), (usize, usize, Longer))| {
            let (first, second) = match truth {
                Longer::First => (j, i),
                Longer::Second | Longer::NotSignificant => (i, j),
            };
            let verdict = match (truth, found) {
                (Longer::NotSignificant, _) => Verdict::Unordered,
                (_, Longer::NotSignificant) => Verdict::Unclear,
                (truth, found) if truth == found => Verdict::Kept,
                _ => Verdict::Reversed,
            };
            Ranked {
                first,
                second,
                verdict,
            }
        };
    orders(reference)
        .zip(orders(candidate))
        .map(rank_pair)
        .collect()
}

/// Which of each pair of programs takes longer, in the order of the pairs.
fn orders(programs: &[Runs]) -> impl Iterator<Item = (usize, usize, Longer)> {
    let sides: Vec<ComparedProgram> = (programs.iter())
        .map(|runs| ComparedProgram {
            varied: &[],
            identity: None,
            runs: runs.clone(),
        })
        .collect();
    let found = pairwise_tests(&sides).into_iter();
    found.map(|contrast| {
        let longer = match contrast.verdict {
            Known::Known(difference) => difference.longer,
            Known::Same | Known::Repeated | Known::Unknown => Longer::NotSignificant,
        };
        (contrast.first, contrast.second, longer)
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::statistics::Observation;

    /// In runs of one number programs have little in common.
    fn around(mean: f64) -> Runs {
        let spread = [-2.0, -1.0, 0.0, 1.0, 2.0];
        let turn = (mean / 10.0) as usize;
        let times = (0..5).map(|run| {
            let time = mean + spread[(run * turn) % 5];
            (run as u64, Observation::completed(time))
        });
        Runs {
            seed: 1,
            times: times.collect(),
        }
    }

    fn verdicts(reference: [f64; 3], candidate: [f64; 3]) -> Vec<(usize, usize, Verdict)> {
        let ranked = rank(&reference.map(around), &candidate.map(around));
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
        let ranked = rank(&reference, &[around(10.0), Runs::default()]);
        assert_eq!(ranked[0].verdict, Verdict::Unclear);
    }

    #[test]
    fn censored_runs_count_as_far_as_they_are_known() {
        let late = Runs {
            seed: 1,
            times: (0..8)
                .map(|run| (run, Observation::censored(100.0)))
                .collect(),
        };
        let reference = [around(10.0), late.clone()];
        let ranked = rank(&reference, &[late, around(10.0)]);
        assert_eq!(ranked[0].verdict, Verdict::Reversed);
    }

    proptest! {
        /// A setting never reverses itself, nor keeps an order that it turned round.
        #[test]
        fn a_setting_agrees_with_itself(
            times in proptest::collection::vec(proptest::collection::vec(1_u32..99, 6), 2..5),
        ) {
            let program = |times: &Vec<u32>| Runs {
                seed: 1,
                times: (0..).zip(times.iter().map(|&t| Observation::completed(t.into()))).collect(),
            };
            let same: Vec<Runs> = times.iter().map(program).collect();
            for pair in rank(&same, &same) {
                prop_assert!(matches!(pair.verdict, Verdict::Kept | Verdict::Unordered));
            }
            let turned = times.iter().map(|it| it.iter().map(|t| 100 - t).collect());
            let turned: Vec<Runs> = turned.map(|it: Vec<u32>| program(&it)).collect();
            for pair in rank(&same, &turned) {
                prop_assert!(matches!(pair.verdict, Verdict::Reversed | Verdict::Unordered));
            }
        }
    }
}
