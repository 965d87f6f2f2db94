//! Pairwise tests of programs, as used by tables, sweeps, reports and trades.
use std::collections::BTreeMap;

use crate::statistics::{Difference, Runs, compare, correct};
use stochc_results::{ChosenSetting, EnsembleProgram, Varied};

/// Unit of the times in a comparison of programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeUnit {
    /// Ticks, if the ticks of all scenes have the same length.
    Ticks,
    /// Seconds, if the ticks of the scenes differ in length.
    Seconds,
}

/// Program in a comparison.
#[derive(Clone, Debug)]
pub struct ComparedProgram<'a> {
    /// Scene parameters that a sweep has changed for this program.
    pub varied: &'a [Varied],
    /// Settings that a sweep has chosen for this program.
    pub chosen: &'a [ChosenSetting],
    /// [`Manifest::runs_identity`](stochc_results::Manifest::runs_identity) of the program.
    /// Programs with the same identity have the same runs. `None` if no other program has the same
    /// runs.
    pub identity: Option<String>,
    /// Times of the program's runs, in the unit of a [`TimeUnit`].
    pub runs: Runs,
}

/// Test of two programs.
#[derive(Clone, Debug, PartialEq)]
pub struct PairwiseTest {
    /// Index of the first program.
    pub first: usize,
    /// Index of the second program.
    pub second: usize,
    /// Result of the comparison.
    pub verdict: PairwiseResult,
}

/// Result of a pairwise test.
#[derive(Clone, Debug, PartialEq)]
pub enum PairwiseResult {
    /// Both programs have the same runs.
    Same,
    /// Another pair with the same runs has already been tested.
    Repeated,
    /// The programs differ, but each run takes the same time in both.
    Equal,
    /// Not testable: too few runs, or no spread of the times.
    Unknown,
    /// Estimated difference with its interval and p-value.
    Known(Difference),
}

impl TimeUnit {
    /// Returns the unit for times of these programs.
    pub fn common<'a>(programs: impl Iterator<Item = &'a EnsembleProgram>) -> TimeUnit {
        let mut ticks = programs.map(|program| program.scene.tick);
        let first = ticks.next();
        if ticks.all(|tick| Some(tick) == first) {
            TimeUnit::Ticks
        } else {
            TimeUnit::Seconds
        }
    }

    /// Returns the length of a program's tick in this unit.
    pub fn tick(self, program: &EnsembleProgram) -> f64 {
        match self {
            TimeUnit::Ticks => 1.0,
            TimeUnit::Seconds => program.scene.tick,
        }
    }

    /// Returns the name of the unit in tables.
    pub fn unit(self) -> &'static str {
        match self {
            TimeUnit::Ticks => "ticks",
            TimeUnit::Seconds => "s",
        }
    }
}

/// Tests all pairs of programs. In a sweep, tests only pairs of different programs with equal
/// values of the axes.
///
/// Programs with the same runs are not tested against each other. Of several pairs with the same
/// runs, only one is tested. Conclusions use p-values that are corrected for the number of tested
/// pairs.
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
            _ => match compare(&first.runs, &second.runs) {
                Some(difference) => PairwiseResult::Known(difference),
                None if first.runs.are_equal(&second.runs) => PairwiseResult::Equal,
                None => PairwiseResult::Unknown,
            },
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

/// Returns the identities of two programs in a canonical order. Returns `None` if one has no
/// identity.
fn identities<'a>(first: &'a ComparedProgram, second: &'a ComparedProgram) -> Option<[&'a str; 2]> {
    let mut both = [first.identity.as_deref()?, second.identity.as_deref()?];
    both.sort_unstable();
    Some(both)
}

/// Selects one of several pairs whose programs have the same runs. Selects the pair with the most
/// runs, or the first such pair.
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

    #[test]
    fn equal_times_of_different_programs_are_stated() {
        let times = [110.0, 230.0, 320.0];
        let verdict = |other: &[f64]| {
            let groups = [group(None, &times), group(None, other)];
            pairwise_tests(&groups).remove(0).verdict
        };
        assert_eq!(verdict(&times), PairwiseResult::Equal);
        assert_eq!(verdict(&times[..2]), PairwiseResult::Equal);
        assert_eq!(verdict(&[111.0]), PairwiseResult::Unknown);
    }

    /// Checks that equal runs are tested only once. Otherwise, passing a folder twice would double
    /// every p-value.
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
        // The pair with more runs is selected.
        assert_eq!(found[0].verdict, PairwiseResult::Repeated);
        assert_eq!(found[1].verdict, PairwiseResult::Same);
        assert_eq!(found[2].verdict, PairwiseResult::Known(expected.clone()));
        assert_eq!(expected.p, expected.p_holm);
    }
}
