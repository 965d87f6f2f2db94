//! Programs side by side: one test and one wording, for the terminal, `results`, sweeps and reports.
use stochc_ir::record::{Outcome, RunRecord};

use super::manifest::{Program, Varied};
use crate::figures::number;
use crate::statistics::{Difference, Longer, Observation, Runs, Test, compare, correct};

/// The unit of times where programs are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// All scenes have the same tick.
    Ticks,
    /// They do not, and ticks would compare nothing.
    Seconds,
}

/// A program that is compared with others.
#[derive(Clone, Debug)]
pub struct Side<'a> {
    /// The numbers that a sweep has chosen for it.
    pub varied: &'a [Varied],
    /// Its runs, in the unit of a [`Clock`].
    pub runs: Runs,
}

/// Two programs side by side.
#[derive(Clone, Debug, PartialEq)]
pub struct Contrast {
    /// Their places among the sides.
    pub first: usize,
    /// See `first`.
    pub second: usize,
    /// What is known of their difference.
    pub verdict: Verdict,
}

/// What is known of a difference.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Both are the same runs of the same program.
    Same,
    /// Too few runs, or no spread.
    Unknown,
    /// An estimate, its interval and p.
    Known(Difference),
}

impl Clock {
    /// The unit that all of these programs have in common.
    pub fn of<'a>(programs: impl Iterator<Item = &'a Program>) -> Clock {
        let mut ticks = programs.map(|program| program.scene.tick);
        let first = ticks.next();
        match ticks.all(|tick| Some(tick) == first) {
            true => Clock::Ticks,
            false => Clock::Seconds,
        }
    }

    /// One tick of a program in this unit.
    pub fn tick(self, program: &Program) -> f64 {
        match self {
            Clock::Ticks => 1.0,
            Clock::Seconds => program.scene.tick,
        }
    }

    /// As tables write it.
    pub fn unit(self) -> &'static str {
        match self {
            Clock::Ticks => "ticks",
            Clock::Seconds => "s",
        }
    }
}

/// The time to completion of a run in ticks; a failed run has none.
pub fn time(record: &RunRecord) -> Option<Observation> {
    let ticks = record.ticks as f64;
    match record.outcome {
        Outcome::Completed => Some(Observation::completed(ticks)),
        Outcome::TimedOut { .. } => Some(Observation::censored(ticks)),
        Outcome::Failed { .. } => None,
    }
}

/// The times of a program's records, sorted by run, in units of which a tick has so many.
pub fn runs<'a>(records: impl Iterator<Item = &'a RunRecord>, seed: u64, tick: f64) -> Runs {
    let timed = |record: &RunRecord| {
        let mut time = time(record)?;
        time.time *= tick;
        Some((record.run, time))
    };
    Runs {
        seed,
        times: records.filter_map(timed).collect(),
    }
}

/// Compares every side with every other one; of a sweep, only different programs at the same values.
///
/// `is_same` says of two places whether they hold the same runs, which are not compared. Each p is
/// also corrected for the number of pairs, and conclusions are drawn from that.
pub fn contrasts(sides: &[Side], is_same: impl Fn(usize, usize) -> bool) -> Vec<Contrast> {
    let mut found = Vec::new();
    for (i, first) in sides.iter().enumerate() {
        let others = sides.iter().enumerate().skip(i + 1);
        for (j, second) in others.filter(|(_, it)| it.varied == first.varied) {
            let verdict = match is_same(i, j) {
                true => Verdict::Same,
                false => {
                    compare(&first.runs, &second.runs).map_or(Verdict::Unknown, Verdict::Known)
                }
            };
            found.push(Contrast {
                first: i,
                second: j,
                verdict,
            });
        }
    }
    correct(found.iter_mut().filter_map(|it| match &mut it.verdict {
        Verdict::Known(difference) => Some(difference),
        _ => None,
    }));
    found
}

/// The sentence on two programs; `names` as they are to stand in it.
///
/// `pairs` is how many differences are told together.
pub fn sentence(names: [&str; 2], verdict: &Verdict, unit: &str, pairs: usize) -> String {
    let [first, second] = names;
    let found = match verdict {
        Verdict::Same => return format!("{first} and {second} are the same runs."),
        Verdict::Unknown => {
            return format!(
                "{first} and {second}: undecided; there are too few runs, or no spread, to tell."
            );
        }
        Verdict::Known(found) => found,
    };
    let conclusion = match found.longer {
        Longer::First => format!("{first} takes longer"),
        Longer::Second => format!("{second} takes longer"),
        Longer::Undecided => "undecided which takes longer".to_owned(),
    };
    format!(
        "{first}~- {second}: {}~±~{}~{unit}, {}, {}: {conclusion}.",
        number(found.difference),
        number(found.half_width),
        p_values(found, pairs),
        method(found, unit),
    )
}

/// `p = 0.03`, and beside it what is left of that among several.
fn p_values(found: &Difference, pairs: usize) -> String {
    let told = |p: f64| match probability(p) {
        p if p.starts_with('<') => format!("p~{}", p.replace(' ', "~")),
        p => format!("p~=~{p}"),
    };
    match pairs {
        0 | 1 => told(found.p),
        _ => format!(
            "{} (of~{pairs} pairs {})",
            told(found.p),
            told(found.p_holm)
        ),
    }
}

/// The test, in words.
pub fn method(found: &Difference, unit: &str) -> String {
    let test = match found.test {
        Test::Paired { pairs } => format!("paired t test of {pairs} runs"),
        Test::Welch { .. } => "Welch's t test".to_owned(),
    };
    match found.horizon {
        Some(horizon) => format!("{test}, times to {} {unit}", number(horizon)),
        None => test,
    }
}

/// A probability, as tables write it.
pub fn probability(p: f64) -> String {
    match p {
        p if p < 1e-4 => "< 0.0001".to_owned(),
        p if p < 0.01 => format!("{p:.4}"),
        p if p < 0.1 => format!("{p:.3}"),
        p => format!("{p:.2}"),
    }
}
