//! Whether two programs take the same time, for every pair of a report.
use super::subject::Subject;
use crate::statistics::{Observation, Test, compare, holm, paired};

/// Two programs side by side.
#[derive(Clone, Debug)]
pub(super) struct Contrast {
    /// Their numbers in the report.
    pub first: usize,
    pub second: usize,
    pub verdict: Verdict,
}

/// What is known of a difference.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Verdict {
    /// Both are the same runs of the same program.
    Same,
    /// Too few runs, or no spread.
    Unknown,
    /// Figures in the clock's unit.
    Known {
        method: Method,
        /// Mean of the first less that of the second.
        difference: f64,
        half_width: f64,
        p: f64,
        /// `p`, corrected by Holm for all pairs of the report.
        corrected: f64,
    },
}

/// How a difference was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Method {
    /// Run by run, because both have the same seed.
    Paired { n: usize },
    /// Welch's t test.
    Welch,
    /// The log-rank test; the means are restricted to the horizon.
    LogRank { horizon: f64 },
}

/// The unit of times where programs are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Clock {
    /// All scenes have the same tick.
    Ticks,
    /// They do not, and ticks would compare nothing.
    Seconds,
}

impl Clock {
    pub fn of(subjects: &[Subject]) -> Clock {
        let mut ticks = subjects.iter().map(|subject| subject.program.scene.tick);
        let first = ticks.next();
        match ticks.all(|tick| Some(tick) == first) {
            true => Clock::Ticks,
            false => Clock::Seconds,
        }
    }

    /// One tick of a program in this unit.
    pub fn tick(self, subject: &Subject) -> f64 {
        match self {
            Clock::Ticks => 1.0,
            Clock::Seconds => subject.program.scene.tick,
        }
    }

    pub fn unit(self) -> &'static str {
        match self {
            Clock::Ticks => "ticks",
            Clock::Seconds => "s",
        }
    }

    /// Times to completion in this unit.
    pub fn times(self, subject: &Subject) -> Vec<Observation> {
        let tick = self.tick(subject);
        let mut times = subject.times();
        for time in &mut times {
            time.time *= tick;
        }
        times
    }
}

/// Compares every program with every other one; of a sweep, only different programs at the same
/// values.
pub(super) fn contrasts(subjects: &[Subject], clock: Clock) -> Vec<Contrast> {
    let mut found = Vec::new();
    for (i, first) in subjects.iter().enumerate() {
        let others = subjects.iter().enumerate().skip(i + 1);
        for (j, second) in others.filter(|(_, it)| it.program.varied == first.program.varied) {
            found.push(Contrast {
                first: i,
                second: j,
                verdict: verdict(first, second, clock),
            });
        }
    }
    let known = |contrast: &Contrast| match contrast.verdict {
        Verdict::Known { p, .. } => Some(p),
        _ => None,
    };
    let mut corrected = holm(&found.iter().filter_map(known).collect::<Vec<_>>()).into_iter();
    for contrast in &mut found {
        if let Verdict::Known { corrected: of, .. } = &mut contrast.verdict {
            *of = corrected.next().unwrap_or(1.0);
        }
    }
    found
}

fn verdict(first: &Subject, second: &Subject, clock: Clock) -> Verdict {
    let twice =
        first.number == second.number && first.manifest.identity() == second.manifest.identity();
    if twice {
        return Verdict::Same;
    }
    let (ours, theirs) = (clock.times(first), clock.times(second));
    let exact = ours.iter().chain(&theirs).all(|time| time.completed);
    if exact && first.manifest.seed == second.manifest.seed {
        let pairs = pairs(first, second, clock);
        if let Some(found) = paired(&pairs) {
            return Verdict::Known {
                method: Method::Paired { n: found.n },
                difference: found.difference,
                half_width: found.half_width,
                p: found.p,
                corrected: found.p,
            };
        }
    }
    let Some(found) = compare(&ours, &theirs) else {
        return Verdict::Unknown;
    };
    Verdict::Known {
        method: match found.test {
            Test::Welch { .. } => Method::Welch,
            Test::LogRank { horizon } => Method::LogRank { horizon },
        },
        difference: found.difference,
        half_width: found.half_width,
        p: found.p,
        corrected: found.p,
    }
}

/// The times of runs with the same number, which have the same draws.
fn pairs(first: &Subject, second: &Subject, clock: Clock) -> Vec<(f64, f64)> {
    let time = |subject: &Subject, i: usize| {
        let time = subject.runs[i].time()?;
        Some(time.time * clock.tick(subject))
    };
    let mut pairs = Vec::new();
    let mut j = 0;
    // Both are sorted by the number of the run.
    for (i, run) in first.runs.iter().enumerate() {
        while second
            .runs
            .get(j)
            .is_some_and(|other| other.record.run < run.record.run)
        {
            j += 1;
        }
        let same = second
            .runs
            .get(j)
            .is_some_and(|other| other.record.run == run.record.run);
        if let (true, Some(ours)) = (same, time(first, i))
            && let Some(theirs) = time(second, j)
        {
            pairs.push((ours, theirs));
        }
    }
    pairs
}
