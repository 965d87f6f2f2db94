//! How long the rest of an ensemble will take.
use std::time::Duration;

use super::board::{Pace, Snapshot};

/// The time left, if ticks go on at the rate seen in `elapsed`; `None`: no run has finished yet.
///
/// A program's runs are taken to need as many ticks as its finished ones did on average, or as
/// those of all programs while it has none.
pub(super) fn time_left(snapshot: &Snapshot, elapsed: Duration) -> Option<Duration> {
    let programs = &snapshot.tally.programs;
    let overall = mean(
        programs.iter().map(|pace| pace.done).sum(),
        programs.iter().map(|pace| pace.ticks).sum(),
    )?;
    let ticks: f64 = programs.iter().map(|pace| ticks_left(pace, overall)).sum();
    if snapshot.ticks_here == 0 {
        return None;
    }
    let seconds = ticks * elapsed.as_secs_f64() / snapshot.ticks_here as f64;
    Duration::try_from_secs_f64(seconds).ok()
}

fn ticks_left(pace: &Pace, overall: f64) -> f64 {
    let mean = mean(pace.done, pace.ticks).unwrap_or(overall);
    (mean * pace.left as f64 - pace.under_way as f64).max(0.0)
}

fn mean(runs: u64, ticks: u64) -> Option<f64> {
    (runs > 0).then(|| ticks as f64 / runs as f64)
}

/// A time as one says it: `40 s`, `3 min`, `2 h 10 min`.
pub(crate) fn words(time: Duration) -> String {
    let seconds = time.as_secs_f64().round() as u64;
    match seconds {
        0..=89 => format!("{seconds} s"),
        90..=5399 => format!("{} min", (seconds + 30) / 60),
        _ => {
            let minutes = (seconds + 30) / 60;
            format!("{} h {} min", minutes / 60, minutes % 60)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ensemble::board::Tally;

    fn pace(done: u64, ticks: u64, left: u64, under_way: u64) -> Pace {
        Pace {
            done,
            ticks,
            left,
            under_way,
        }
    }

    #[test]
    fn runs_of_a_slow_program_count_for_more() {
        let snapshot = Snapshot {
            tally: Tally {
                programs: vec![pace(2, 200, 1, 40), pace(1, 1000, 2, 0)],
                ..Tally::default()
            },
            ticks_here: 1240,
            ..Snapshot::default()
        };
        // 100 - 40 ticks of the first program and 2000 of the second, at 124 a second.
        let left = time_left(&snapshot, Duration::from_secs(10)).unwrap();
        assert_eq!(left, Duration::from_secs_f64(2060.0 / 124.0));
    }

    #[test]
    fn before_the_first_finished_run_nothing_is_promised() {
        let snapshot = Snapshot {
            tally: Tally {
                programs: vec![pace(0, 0, 5, 900)],
                ..Tally::default()
            },
            ticks_here: 900,
            ..Snapshot::default()
        };
        assert_eq!(time_left(&snapshot, Duration::from_secs(10)), None);
    }

    #[test]
    fn times_are_told_in_words() {
        let told = [0, 89, 90, 3600, 5400, 7800].map(|s| words(Duration::from_secs(s)));
        assert_eq!(
            told,
            ["0 s", "89 s", "2 min", "60 min", "1 h 30 min", "2 h 10 min"]
        );
    }
}
