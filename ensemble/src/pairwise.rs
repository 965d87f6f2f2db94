//! Tests of every pair of programs: one for tables, sweeps, reports and trades.

use super::manifest::{EnsembleProgram, Varied};
use crate::statistics::{Difference, Runs, compare, correct};

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
    /// Too few runs, or no spread.
    Unknown,
    /// An estimate, its interval and p.
    Known(Difference),
}

impl TimeUnit {
    /// The unit that all of these programs have in common.
    pub fn of<'a>(programs: impl Iterator<Item = &'a EnsembleProgram>) -> TimeUnit {
        let mut ticks = programs.map(|program| program.scene.tick);
        let first = ticks.next();
        match ticks.all(|tick| Some(tick) == first) {
            true => TimeUnit::Ticks,
            false => TimeUnit::Seconds,
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
/// `is_same` says of two places whether they hold the same runs, which are not compared. Each p is
/// also corrected for the number of pairs, and conclusions are drawn from that.
pub fn pairwise_tests(
    groups: &[ComparedProgram],
    is_same: impl Fn(usize, usize) -> bool,
) -> Vec<PairwiseTest> {
    let mut found = Vec::new();
    for (i, first) in groups.iter().enumerate() {
        let others = groups.iter().enumerate().skip(i + 1);
        for (j, second) in others.filter(|(_, it)| it.varied == first.varied) {
            let verdict = match is_same(i, j) {
                true => PairwiseResult::Same,
                false => compare(&first.runs, &second.runs)
                    .map_or(PairwiseResult::Unknown, PairwiseResult::Known),
            };
            found.push(PairwiseTest {
                first: i,
                second: j,
                verdict,
            });
        }
    }
    correct(found.iter_mut().filter_map(|it| match &mut it.verdict {
        PairwiseResult::Known(difference) => Some(difference),
        _ => None,
    }));
    found
}
