//! Runs of programs by number, so that equal numbers can be paired.
use super::share::unseen_share_error;
use super::{KaplanMeier, Observation, Status};

/// Times of a program's runs with their numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Runs {
    /// Seed of the runs. Runs with equal seeds and numbers have the same random draws in all
    /// programs.
    pub seed: u64,
    /// Number and time of each run, sorted by number. The unit of time is arbitrary. Failed runs
    /// are excluded.
    pub times: Vec<(u64, Observation)>,
}

impl Runs {
    /// Returns the runs with their times converted from ticks to another unit. `tick` is the length
    /// of a tick in that unit.
    pub fn new(seed: u64, mut times: Vec<(u64, Observation)>, tick: f64) -> Runs {
        for (_, time) in &mut times {
            time.time *= tick;
        }
        Runs { seed, times }
    }

    /// Returns the times, sorted by run number.
    pub fn observations(&self) -> Vec<Observation> {
        self.times.iter().map(|&(_, time)| time).collect()
    }

    /// Returns whether the two programs have runs with the same number, and the two runs of each
    /// such pair take the same time.
    pub(crate) fn are_equal(&self, other: &Runs) -> bool {
        let ours = self.shared(other);
        self.seed == other.seed && !ours.is_empty() && ours == other.shared(self)
    }

    /// Returns the runs whose number also occurs in `other`.
    pub(super) fn shared(&self, other: &Runs) -> Vec<Observation> {
        let has_partner = |number: &u64| {
            let place = other.times.binary_search_by_key(number, |&(it, _)| it);
            place.is_ok()
        };
        let shared = self.times.iter().filter(|(number, _)| has_partner(number));
        shared.map(|&(_, time)| time).collect()
    }
}

/// Two samples of values whose means can be compared.
pub(super) struct Comparable {
    /// For each sample, one value per time, in the order of the times.
    pub values: [Vec<f64>; 2],
    /// Additional standard error of each mean. If no run completes before the horizon, all values
    /// are equal, and the only error is the unknown share of runs that would complete. This value
    /// is an upper bound: it assumes that these runs would complete at once.
    pub unseen: [f64; 2],
    /// Horizon of the restricted means. `None` if all times are known.
    pub horizon: Option<f64>,
}

/// Returns values for two samples. Their means are the restricted means of the samples. Returns
/// `None` if a sample is empty.
///
/// The horizon is the end of the time range that both curves cover. If some runs never complete,
/// the horizon is at most the last observed time of both samples.
pub(super) fn comparable(first: &[Observation], second: &[Observation]) -> Option<Comparable> {
    let curves = [KaplanMeier::new(first)?, KaplanMeier::new(second)?];
    let reach = curves.iter().map(KaplanMeier::reach);
    let mut horizon = reach.fold(f64::INFINITY, f64::min);
    let mut all = first.iter().chain(second);
    if all.any(|run| run.status == Status::Competing) {
        // The curve of runs that never complete has no end, so the mean requires a finite horizon.
        horizon = horizon.min(curves[0].last().max(curves[1].last()));
    }
    let values = |curve: &KaplanMeier, sample: &[Observation]| {
        if sample
            .iter()
            .all(|run| run.is_completed() && run.time <= horizon)
        {
            // Return the original times, bit for bit.
            return sample.iter().map(|run| run.time).collect();
        }
        curve.contributions(sample, horizon)
    };
    let unseen = |sample: &[Observation]| {
        let is_seen = |run: &Observation| run.is_completed() && run.time < horizon;
        if horizon.is_finite() && !sample.iter().any(is_seen) {
            horizon * unseen_share_error(sample.len())
        } else {
            0.0
        }
    };
    Some(Comparable {
        values: [values(&curves[0], first), values(&curves[1], second)],
        unseen: [unseen(first), unseen(second)],
        horizon: horizon.is_finite().then_some(horizon),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn horizon(first: &[Observation], second: &[Observation]) -> Option<f64> {
        comparable(first, second).unwrap().horizon
    }

    /// Checks the horizon of two samples. Curves of runs that never complete are known for all
    /// times. The horizon is then the last observed time of both samples, or the end of a known
    /// curve.
    #[test]
    fn needed_runs_use_the_common_horizon() {
        let done = [1.0, 5.0].map(Observation::completed);
        let never = [Observation::completed(2.0), Observation::competing(3.0)];
        let hidden = [Observation::completed(2.0), Observation::censored(4.0)];
        assert_eq!(horizon(&done, &done), None);
        assert_eq!(horizon(&done, &never), Some(5.0));
        assert_eq!(horizon(&done, &hidden), Some(4.0));
        assert_eq!(horizon(&never, &hidden), Some(4.0));
        assert_eq!(horizon(&never, &never), Some(3.0));
        let values = comparable(&done, &never).unwrap().values;
        assert_eq!(values, [[1.0, 5.0], [2.0, 5.0]]);
    }

    /// Checks four runs that do not complete. By Wilson's interval, up to 49 % of all runs could
    /// complete.
    #[test]
    fn without_completion_the_needed_runs_are_unknown() {
        let never = [Observation::competing(300.0); 4];
        let done = [100.0, 200.0].map(Observation::completed);
        let [unseen, seen] = comparable(&never, &done).unwrap().unseen;
        assert!((1.96 * unseen / 300.0 - 0.49).abs() < 1e-3, "{unseen}");
        assert_eq!(seen, 0.0);
        let many = [Observation::competing(300.0); 400];
        let [unseen, _] = comparable(&many, &done).unwrap().unseen;
        assert!((1.96 * unseen / 300.0 - 0.0095).abs() < 1e-4, "{unseen}");
    }
}
