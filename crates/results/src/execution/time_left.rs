//! Estimate of the remaining time of an ensemble.
use std::time::Duration;

use crate::execution::{ProgramProgress, Snapshot};

/// Returns the remaining time at the rate of ticks simulated during `elapsed`. Returns `None` if no
/// run has finished yet, or if the running simulations already take longer than the mean.
///
/// The unfinished runs of a program are assumed to have the mean number of ticks of its finished
/// runs. A program without finished runs has the mean of all programs.
pub fn time_left(snapshot: &Snapshot, elapsed: Duration) -> Option<Duration> {
    let programs = &snapshot.totals.programs;
    let overall = mean(
        programs.iter().map(|pace| pace.done).sum(),
        (programs.iter()).fold(0, |sum, pace| pace.ticks.saturating_add(sum)),
    )?;
    let ticks: f64 = programs.iter().map(|pace| ticks_left(pace, overall)).sum();
    if snapshot.ticks_here == 0 || ticks <= 0.0 && snapshot.done < snapshot.total {
        return None;
    }
    let seconds = ticks * elapsed.as_secs_f64() / snapshot.ticks_here as f64;
    Duration::try_from_secs_f64(seconds).ok()
}

fn ticks_left(pace: &ProgramProgress, overall: f64) -> f64 {
    let mean = mean(pace.done, pace.ticks).unwrap_or(overall);
    (mean * pace.left as f64 - pace.running as f64).max(0.0)
}

fn mean(runs: u64, ticks: u64) -> Option<f64> {
    (runs > 0).then(|| ticks as f64 / runs as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::execution::Totals;

    fn pace(done: u64, ticks: u64, left: u64, running: u64) -> ProgramProgress {
        ProgramProgress {
            done,
            ticks,
            left,
            running,
        }
    }

    #[test]
    fn runs_of_a_slow_program_count_for_more() {
        let snapshot = Snapshot {
            totals: Totals {
                programs: vec![pace(2, 200, 1, 40), pace(1, 1000, 2, 0)],
                ..Totals::default()
            },
            ticks_here: 1240,
            ..Snapshot::default()
        };
        // The programs have 100 - 40 and 2000 ticks left, at 124 ticks per second.
        let left = time_left(&snapshot, Duration::from_secs(10)).unwrap();
        assert_eq!(left, Duration::from_secs_f64(2060.0 / 124.0));
    }

    #[test]
    fn without_a_finished_run_there_is_no_estimate() {
        let snapshot = Snapshot {
            totals: Totals {
                programs: vec![pace(0, 0, 5, 900)],
                ..Totals::default()
            },
            ticks_here: 900,
            ..Snapshot::default()
        };
        assert_eq!(time_left(&snapshot, Duration::from_secs(10)), None);
    }

    #[test]
    fn a_slow_last_run_has_no_estimate() {
        let snapshot = Snapshot {
            total: 8,
            done: 7,
            totals: Totals {
                programs: vec![pace(7, 700, 1, 120)],
                ..Totals::default()
            },
            ticks_here: 820,
            ..Snapshot::default()
        };
        assert_eq!(time_left(&snapshot, Duration::from_secs(10)), None);
    }
}
