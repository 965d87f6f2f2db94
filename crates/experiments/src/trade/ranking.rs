//! Order of programs by their times with some settings, compared with the order at the reference.
use std::collections::HashMap;

use serde::Serialize;

use crate::statistics::Longer;
use crate::{Comparison, PairwiseResult};

/// Pair of programs. The first program is faster with the reference settings.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Ranked {
    /// Index of the first program.
    pub first: usize,
    /// Index of the second program.
    pub second: usize,
    /// Conclusion about the order of the pair.
    pub verdict: Verdict,
}

/// Verdict on settings: whether they keep the order of two programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The difference is not significant at the reference.
    Unordered,
    /// The order is the same as at the reference, and significant.
    Preserved,
    /// The difference is significant only at the reference.
    Unclear,
    /// The order is significantly reversed: the settings give a wrong conclusion.
    Reversed,
}

/// For each tested pair of programs, which of the two takes longer. The key is the pair of names.
pub(super) struct Orders<'a>(HashMap<(&'a str, &'a str), Longer>);

impl<'a> Orders<'a> {
    /// Returns the conclusions of a comparison for all tested pairs.
    pub fn new(comparison: &'a Comparison) -> Orders<'a> {
        let pairs = comparison.pairs.iter();
        let orders = pairs.map(|pair| {
            let longer = match &pair.verdict {
                PairwiseResult::Known(difference) => difference.longer,
                PairwiseResult::Same
                | PairwiseResult::Repeated
                | PairwiseResult::Equal
                | PairwiseResult::Unknown => Longer::NotSignificant,
            };
            ((&*pair.first, &*pair.second), longer)
        });
        Orders(orders.collect())
    }

    /// For each pair of programs, compares the order at the candidate settings with the order at
    /// the reference settings.
    ///
    /// Both lists contain the names of the same programs in the ensemble. A name is `None` if the
    /// program has no runs.
    pub fn rank(&self, reference: &[Option<&str>], candidate: &[Option<&str>]) -> Vec<Ranked> {
        let places = 0..reference.len();
        let pairs = places.flat_map(|i| (i + 1..reference.len()).map(move |j| (i, j)));
        let ranked = pairs.filter_map(|(i, j)| {
            let longer = |names: &[Option<&str>]| self.0.get(&(names[i]?, names[j]?)).copied();
            // Programs of different scenes are not compared.
            let truth = longer(reference)?;
            let found = longer(candidate).unwrap_or(Longer::NotSignificant);
            let (first, second) = match truth {
                Longer::First => (j, i),
                Longer::Second | Longer::NotSignificant => (i, j),
            };
            Some(Ranked {
                first,
                second,
                verdict: match (truth, found) {
                    (Longer::NotSignificant, _) => Verdict::Unordered,
                    (_, Longer::NotSignificant) => Verdict::Unclear,
                    (truth, found) if truth == found => Verdict::Preserved,
                    _ => Verdict::Reversed,
                },
            })
        });
        ranked.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_is_reversed_only_if_both_orders_are_significant() {
        use Longer::{First, NotSignificant, Second};
        let names = ["a", "b", "c", "A", "B", "C"];
        let verdicts = |reference: [Longer; 3], candidate: [Longer; 3]| {
            let pairs = [(0, 1), (0, 2), (1, 2), (3, 4), (3, 5), (4, 5)];
            let found = reference.into_iter().chain(candidate);
            let orders = pairs.into_iter().map(|(i, j)| (names[i], names[j]));
            let orders = Orders(orders.zip(found).collect());
            let [truth, other] = [0, 3].map(|at| [0, 1, 2].map(|i| Some(names[at + i])));
            let ranked = orders.rank(&truth, &other);
            let ranked = ranked.iter().map(|it| (it.first, it.second, it.verdict));
            ranked.collect::<Vec<_>>()
        };
        use Verdict::{Preserved, Reversed, Unclear, Unordered};
        assert_eq!(
            verdicts([First, First, NotSignificant], [First, First, Second]),
            [(1, 0, Preserved), (2, 0, Preserved), (1, 2, Unordered)]
        );
        assert_eq!(
            verdicts([First, Second, First], [Second, NotSignificant, First]),
            [(1, 0, Reversed), (0, 2, Unclear), (2, 1, Preserved)]
        );
        // Program `b` was not run with the candidate's settings.
        let orders = Orders([(("a", "b"), First)].into());
        let ranked = orders.rank(&[Some("a"), Some("b")], &[Some("A"), None]);
        assert_eq!(ranked[0].verdict, Unclear);
        assert_eq!(orders.rank(&[Some("a"), Some("c")], &[None, None]), []);
    }
}
