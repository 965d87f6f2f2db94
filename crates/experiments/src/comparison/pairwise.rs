//! Tests of every pair of programs: one for tables, sweeps, reports and trades.
use std::collections::BTreeMap;

use crate::statistics::{Difference, Runs, compare, correct};
use stochc_results::{ChosenSetting, EnsembleProgram, Varied};

/// The unit of times where programs are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeUnit {
    /// All scenes have the same tick.
    Ticks,
    /// They do not, and ticks would compare nothing.
    Seconds,
}

/// A program that is compared with others.
#[derive(Clone, Debug)]
pub struct ComparedProgram<'a> {
    /// The numbers that a sweep has chosen for it.
    pub varied: &'a [Varied],
    /// The settings that a sweep has chosen for it.
    pub chosen: &'a [ChosenSetting],
    /// What decides its runs ([`Manifest::runs_identity`](stochc_results::Manifest::runs_identity)): programs of one identity have the
    /// same runs; `None`: its runs are its own.
    pub identity: Option<String>,
    /// Its runs, in the unit of a [`TimeUnit`].
    pub runs: Runs,
}

/// Two programs side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct PairwiseTest {
    /// Their places among the groups.
    pub first: usize,
    /// See `first`.
    pub second: usize,
    /// What is known of their difference.
    pub verdict: PairwiseResult,
}

/// What is known of a difference.
#[derive(Clone, Debug, PartialEq)]
pub enum PairwiseResult {
    /// Both are the same runs of the same program.
    Same,
    /// Their runs are those of another pair, which is tested.
    Repeated,
    /// Too few runs, or no spread.
    Unknown,
    /// An estimate, its interval and p.
    Known(Difference),
}

impl TimeUnit {
    /// The unit that all of these programs have in common.
    pub fn common<'a>(programs: impl Iterator<Item = &'a EnsembleProgram>) -> TimeUnit {
        let mut ticks = programs.map(|program| program.scene.tick);
        let first = ticks.next();
        if ticks.all(|tick| Some(tick) == first) {
            TimeUnit::Ticks
        } else {
            TimeUnit::Seconds
        }
    }

    /// One tick of a program in this unit.
    pub fn tick(self, program: &EnsembleProgram) -> f64 {
        match self {
            TimeUnit::Ticks => 1.0,
            TimeUnit::Seconds => program.scene.tick,
        }
    }

    /// As tables write it.
    pub fn unit(self) -> &'static str {
        match self {
            TimeUnit::Ticks => "ticks",
            TimeUnit::Seconds => "s",
        }
    }
}

/// Compares every side with every other one; of a sweep, only different programs at the same values.
///
/// The same runs are not compared with each other, and of pairs with the same runs one is tested. Each p is
/// also corrected for the number of pairs that are, and conclusions are drawn from that.
pub fn pairwise_tests(groups: &[ComparedProgram]) -> Vec<PairwiseTest> {
    let mut pairs = Vec::new();
    for (i, first) in groups.iter().enumerate() {
        let others = groups.iter().enumerate().skip(i + 1);
        let comparable =
            others.filter(|(_, it)| (it.varied, it.chosen) == (first.varied, first.chosen));
        pairs.extend(comparable.map(|(j, _)| (i, j)));
    }
    let tested = tested(groups, &pairs);
    let test = |(i, j): (usize, usize)| {
        let (first, second) = (&groups[i], &groups[j]);
        let verdict = match identities(first, second) {
            Some([a, b]) if a == b => PairwiseResult::Same,
            Some(both) if tested[&both] != (i, j) => PairwiseResult::Repeated,
            _ => compare(&first.runs, &second.runs)
                .map_or(PairwiseResult::Unknown, PairwiseResult::Known),
        };
        PairwiseTest {
            first: i,
            second: j,
            verdict,
        }
    };
    let mut found: Vec<PairwiseTest> = pairs.iter().copied().map(test).collect();
    correct(found.iter_mut().filter_map(|it| match &mut it.verdict {
        PairwiseResult::Known(difference) => Some(difference),
        _ => None,
    }));
    found
}

/// The identities of both, in an order that does not depend on theirs; `None`: one has none.
fn identities<'a>(first: &'a ComparedProgram, second: &'a ComparedProgram) -> Option<[&'a str; 2]> {
    let mut both = [first.identity.as_deref()?, second.identity.as_deref()?];
    both.sort_unstable();
    Some(both)
}

/// Of all pairs of the same runs the one with the most of them, and of several with as many the first.
fn tested<'a>(
    groups: &'a [ComparedProgram],
    pairs: &[(usize, usize)],
) -> BTreeMap<[&'a str; 2], (usize, usize)> {
    let runs = |(i, j): (usize, usize)| groups[i].runs.times.len() + groups[j].runs.times.len();
    let mut found = BTreeMap::new();
    for &pair in pairs {
        let Some(both) = identities(&groups[pair.0], &groups[pair.1]) else {
            continue;
        };
        let best = found.entry(both).or_insert(pair);
        if runs(pair) > runs(*best) {
            *best = pair;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::Observation;

    fn group(identity: Option<&str>, times: &[f64]) -> ComparedProgram<'static> {
        let times = times.iter().copied().map(Observation::completed);
        ComparedProgram {
            varied: &[],
            chosen: &[],
            identity: identity.map(str::to_owned),
            runs: Runs {
                seed: 1,
                times: (0..).zip(times).collect(),
            },
        }
    }

    /// Otherwise a folder that is named twice would double every p.
    #[test]
    fn the_same_runs_are_tested_once() {
        let slow = [110.0, 230.0, 320.0, 440.0];
        let fast = [100.0, 200.0, 300.0, 400.0];
        let alone = pairwise_tests(&[group(None, &slow), group(None, &fast)]);
        let PairwiseResult::Known(expected) = &alone[0].verdict else {
            panic!("{alone:?}");
        };
        let groups = [
            group(Some("fast"), &fast[..3]),
            group(Some("slow"), &slow),
            group(Some("fast"), &fast),
        ];
        let found = pairwise_tests(&groups);
        let verdicts: Vec<_> = found.iter().map(|it| (it.first, it.second)).collect();
        assert_eq!(verdicts, [(0, 1), (0, 2), (1, 2)]);
        // The pair with more runs counts.
        assert_eq!(found[0].verdict, PairwiseResult::Repeated);
        assert_eq!(found[1].verdict, PairwiseResult::Same);
        assert_eq!(found[2].verdict, PairwiseResult::Known(expected.clone()));
        assert_eq!(expected.p, expected.p_holm);
    }
}
