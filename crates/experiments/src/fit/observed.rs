//! Statistics of measured times, which may be right-censored.
use crate::statistics::{KaplanMeier, Observation, Summary};

/// Minimum fraction of runs that must have been observed until the horizon. Counts only runs that
/// lasted longer than the horizon.
const FOLLOWED: f64 = 0.5;

/// Statistics of a program's measured completion times, or of the waiting times of a capture.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Observed {
    /// Name of the capture, such as `grow: A.up -> B`, whose waiting times replace the times of the
    /// runs. `None` for completion times.
    pub capture: Option<String>,
    /// Number of times, at least 2.
    pub n: usize,
    /// Number of right-censored times.
    pub stopped: usize,
    /// Horizon, in the unit of the table. Longer times are replaced by the horizon. `None` if all
    /// times are used unchanged.
    pub horizon: Option<f64>,
    /// Mean of the times. Each time is limited by the horizon.
    pub mean: f64,
    /// Standard deviation of the times.
    pub sd: f64,
    /// Fraction of times that are longer than the horizon. 0 without a horizon.
    pub incomplete: f64,
    /// Effective number of times: number of completely observed times that would be equally
    /// informative.
    pub effective_n: f64,
}

impl Observed {
    pub(crate) fn from_summary(n: usize, mean: f64, sd: f64) -> Observed {
        Observed {
            capture: None,
            n,
            stopped: 0,
            horizon: None,
            mean,
            sd,
            incomplete: 0.0,
            effective_n: n as f64,
        }
    }

    /// Returns the statistics of runs, which may be right-censored. Returns `None` for too few
    /// runs.
    ///
    /// # Source
    ///
    /// The restricted mean and its variance: E. L. Kaplan and P. Meier, J. Am. Stat. Assoc. 53, 457
    /// (1958).
    pub fn from_runs(runs: &[Observation]) -> Option<Observed> {
        let stopped = runs.iter().filter(|run| !run.is_completed()).count();
        if stopped == 0 {
            let times: Vec<f64> = runs.iter().map(|run| run.time).collect();
            let summary = Summary::from_values(&times)?;
            let sd = summary.sd.filter(|sd| *sd > 0.0)?;
            return Some(Observed::from_summary(summary.n, summary.mean, sd));
        }
        if runs.len() < 2 {
            return None;
        }
        Observed::limited(runs, horizon(runs))
    }

    /// Returns the statistics of each capture's waiting times, which may be right-censored. Leaves
    /// out captures with too few of them.
    ///
    /// All captures have a horizon, at most twice the program's mean waiting time. All statistics
    /// are then means. With logarithms, the small biases of many captures would add up.
    pub fn from_captures(captures: &[(String, Vec<Observation>)]) -> Vec<Observed> {
        let all = captures.iter().flat_map(|(_, waits)| waits);
        let total: f64 = all.clone().map(|wait| wait.time).sum();
        let ended = all.filter(|wait| wait.is_completed()).count();
        let limit = 2.0 * total / ended as f64;
        let observed = captures.iter().map(|(capture, waits)| {
            let horizon = horizon(waits).map_or(limit, |horizon| horizon.min(limit));
            let is_known = waits.len() >= 2 && horizon > 0.0;
            let observed = is_known.then(|| Observed::limited(waits, Some(horizon)))??;
            Some(Observed {
                capture: Some(capture.clone()),
                ..observed
            })
        });
        observed.flatten().collect()
    }

    /// Returns the statistics of at least two times, limited by the horizon.
    fn limited(runs: &[Observation], horizon: Option<f64>) -> Option<Observed> {
        let stopped = runs.iter().filter(|run| !run.is_completed()).count();
        let end = horizon.unwrap_or(f64::INFINITY);
        let cut = cut(runs, end);
        let curve = KaplanMeier::new(&cut)?;
        let n = runs.len() as f64;
        let (mean, variance) = moments(&curve, end);
        // Without a horizon, use the sample variance, as for complete runs.
        let correction = if horizon.is_some() {
            1.0
        } else {
            n / (n - 1.0)
        };
        if horizon.is_none() && variance <= 0.0 {
            return None;
        }
        Some(Observed {
            capture: None,
            n: runs.len(),
            stopped,
            horizon,
            mean,
            sd: (variance * correction).sqrt(),
            incomplete: horizon.map_or(0.0, |end| curve.incomplete(end)),
            effective_n: effective_n(&curve, &cut, end),
        })
    }

    /// Returns the mean square of the times. Each time is limited by the horizon.
    pub(super) fn second_moment(&self) -> f64 {
        self.mean * self.mean + self.sd * self.sd
    }
}

/// Returns the horizon: the latest time when enough runs were still observed. If all runs have the
/// same limit, this is the limit.
///
/// Returns `None` if enough runs were observed to completion.
fn horizon(runs: &[Observation]) -> Option<f64> {
    let curve = KaplanMeier::new(runs)?;
    let mut stops: Vec<f64> = (runs.iter().filter(|run| !run.is_completed()))
        .map(|run| run.time)
        .collect();
    stops.sort_by(f64::total_cmp);
    let last = *stops.last()?;
    let later = runs.iter().filter(|run| run.time > last).count();
    if later > 0 && is_enough(later, curve.incomplete(last), runs) {
        return None;
    }
    let is_horizon = |time: &&f64| is_followed(runs, &curve, **time);
    stops.iter().rev().find(is_horizon).copied()
}

/// Returns whether enough of the runs that lasted longer than `time` were observed until then.
pub(super) fn is_followed(runs: &[Observation], curve: &KaplanMeier, time: f64) -> bool {
    let followed = runs.iter().filter(|run| run.at_risk_until() >= time);
    is_enough(followed.count(), curve.incomplete(time.next_down()), runs)
}

fn is_enough(followed: usize, incomplete: f64, runs: &[Observation]) -> bool {
    followed as f64 >= FOLLOWED * incomplete * runs.len() as f64
}

/// Returns the observations, each censored at `end` if it is longer.
pub(super) fn cut(runs: &[Observation], end: f64) -> Vec<Observation> {
    let cut = |run: &Observation| {
        if run.time > end {
            Observation::censored(end)
        } else {
            *run
        }
    };
    runs.iter().map(cut).collect()
}

/// Returns the mean and the variance of times that are limited by a horizon.
fn moments(curve: &KaplanMeier, horizon: f64) -> (f64, f64) {
    let restricted = curve.restricted_mean(horizon);
    let square = |(time, share): (f64, f64)| share * time.min(restricted.horizon).powi(2);
    let square: f64 = curve.shares().map(square).sum();
    (restricted.mean, (square - restricted.mean.powi(2)).max(0.0))
}

/// Returns the effective number of runs: the number of uncensored runs with the same variance of
/// the restricted mean. Times are limited by a horizon.
pub(super) fn effective_n(curve: &KaplanMeier, runs: &[Observation], horizon: f64) -> f64 {
    let end = curve.restricted_mean(horizon).horizon;
    let (mean, variance) = moments(curve, end);
    let contributions = curve.contributions(runs, end);
    let squares: f64 = contributions.iter().map(|it| (it - mean).powi(2)).sum();
    let n = runs.len() as f64;
    if squares > 0.0 && variance > 0.0 {
        (n * n * variance / squares).min(n)
    } else {
        runs.iter()
            .map(|run| run.at_risk_until().min(end) / end)
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(completed: &[f64], stopped: &[f64]) -> Vec<Observation> {
        let completed = completed.iter().map(|time| Observation::completed(*time));
        let stopped = stopped.iter().map(|time| Observation::censored(*time));
        completed.chain(stopped).collect()
    }

    #[test]
    fn one_limit_is_the_horizon() {
        let found = Observed::from_runs(&runs(&[10.0, 20.0, 40.0], &[50.0; 3])).unwrap();
        let mean = (10.0 + 20.0 + 40.0 + 150.0) / 6.0;
        let square = (100.0 + 400.0 + 1600.0 + 7500.0) / 6.0;
        assert_eq!((found.n, found.stopped, found.horizon), (6, 3, Some(50.0)));
        assert!((found.mean - mean).abs() < 1e-9, "{found:?}");
        assert!((found.second_moment() - square).abs() < 1e-9, "{found:?}");
        assert!((found.incomplete - 0.5).abs() < 1e-12, "{found:?}");
        assert!((found.effective_n - 6.0).abs() < 1e-9, "{found:?}");
        let none = Observed::from_runs(&runs(&[], &[50.0, 50.0])).unwrap();
        assert_eq!((none.mean, none.sd, none.incomplete), (50.0, 0.0, 1.0));
        assert_eq!(none.effective_n, 2.0);
    }

    #[test]
    fn a_few_early_stops_do_not_shorten_the_horizon() {
        let times: Vec<f64> = (1..=40).map(f64::from).collect();
        let found = Observed::from_runs(&runs(&times, &[3.0, 5.0])).unwrap();
        assert_eq!((found.stopped, found.horizon), (2, None));
        assert!((40.0..41.9).contains(&found.effective_n), "{found:?}");
        // The runs that lasted longer share the weight of an early censored run.
        assert!(found.mean > 20.5 && found.mean < 21.5, "{found:?}");
        let complete = Observed::from_runs(&runs(&times, &[])).unwrap();
        assert_eq!((complete.mean, complete.effective_n), (20.5, 40.0));
    }

    #[test]
    fn the_horizon_has_half_of_the_runs_at_risk() {
        // Ten of a hundred runs had no limit.
        let longer = [60.0, 70.0, 80.0, 90.0, 95.0];
        let times: Vec<f64> = (1..=45).map(f64::from).chain(longer).collect();
        let found = Observed::from_runs(&runs(&times, &[50.0; 50])).unwrap();
        assert_eq!(found.horizon, Some(50.0), "{found:?}");
        assert!((found.incomplete - 0.55).abs() < 1e-12, "{found:?}");
        let straggler = Observed::from_runs(&runs(
            &times[..45],
            &[[50.0; 50].as_slice(), &[900.0]].concat(),
        ));
        assert_eq!(straggler.unwrap().horizon, Some(50.0));
    }

    #[test]
    fn censored_waits_of_captures_count() {
        let limit_of = |waits: Vec<Observation>| {
            let one = Observed::from_captures(&[("a".to_owned(), waits)]);
            (one[0].n, one[0].stopped, one[0].horizon, one[0].incomplete)
        };
        // The mean waiting time is 100 / 4 of complete waits, and 400 / 4 with censored ones.
        let ended = [10.0, 20.0, 30.0, 40.0];
        let complete = limit_of(runs(&ended, &[]));
        assert_eq!(complete, (4, 0, Some(50.0), 0.0));
        let censored = limit_of(runs(&ended, &[60.0; 5]));
        assert_eq!(censored.0, 9);
        assert_eq!((censored.1, censored.2), (5, Some(60.0)));
        assert!((censored.3 - 5.0 / 9.0).abs() < 1e-12, "{censored:?}");
        // A fast and a slow capture have one limit: twice their mean of 30.
        let captures = [runs(&[4.0, 6.0], &[]), runs(&[40.0, 70.0], &[])];
        let captures = captures.map(|waits| ("a".to_owned(), waits));
        let [fast, slow] = &Observed::from_captures(&captures)[..] else {
            panic!("two captures");
        };
        assert_eq!((fast.mean, fast.horizon), (5.0, Some(60.0)));
        assert_eq!((slow.mean, slow.incomplete), (50.0, 0.5));
    }

    /// Runs that never complete are completely known: they last longer than every horizon.
    #[test]
    fn runs_that_never_complete_are_as_informative_as_others() {
        for never in [3, 12, 21] {
            let completed = (1..=24 - never).map(|time| Observation::completed(f64::from(time)));
            let never = (0..never).map(|_| Observation::competing(50.0));
            let runs: Vec<_> = completed.chain(never).collect();
            let curve = KaplanMeier::new(&runs).unwrap();
            let found = effective_n(&curve, &runs, 1000.0);
            assert!((found - 24.0).abs() < 1e-9, "{found}");
        }
    }

    #[test]
    fn rejects_times_without_spread() {
        for runs in [runs(&[1.0], &[]), runs(&[2.0, 2.0], &[]), runs(&[], &[1.0])] {
            assert_eq!(Observed::from_runs(&runs), None);
        }
    }
}
