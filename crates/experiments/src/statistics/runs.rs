//! Runs by their number: what can be put in pairs.
use super::share::unseen_share_error;
use super::{KaplanMeier, Observation, Status};

/// The times of a program's runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Runs {
    /// The seed of their draws. Runs of one seed and one number meet the same chance, whatever their
    /// program is.
    pub seed: u64,
    /// Number and time of each, by number; the time in any one unit. A failed run has none.
    pub times: Vec<(u64, Observation)>,
}

impl Runs {
    /// Times in ticks, of which each has so many of the unit.
    pub fn new(seed: u64, mut times: Vec<(u64, Observation)>, tick: f64) -> Runs {
        for (_, time) in &mut times {
            time.time *= tick;
        }
        Runs { seed, times }
    }

    /// Their times, by number.
    pub fn observations(&self) -> Vec<Observation> {
        self.times.iter().map(|&(_, time)| time).collect()
    }

    /// Those that have a partner of their number in `other`.
    pub(super) fn shared(&self, other: &Runs) -> Vec<Observation> {
        let has_partner = |number: &u64| {
            let place = other.times.binary_search_by_key(number, |&(it, _)| it);
            place.is_ok()
        };
        let shared = self.times.iter().filter(|(number, _)| has_partner(number));
        shared.map(|&(_, time)| time).collect()
    }
}

/// Two samples as values whose means can be compared.
pub(super) struct Comparable {
    /// One value for each time, in their order.
    pub values: [Vec<f64>; 2],
    /// A further standard error of each mean. Where no run completes before the horizon, the values do not differ, and chance is in how many
    /// others would: at worst these complete at once.
    pub unseen: [f64; 2],
    /// Times count up to here; `None`: all are known.
    pub horizon: Option<f64>,
}

/// Values whose means are those of both samples, restricted to the last time up to which both are
/// known, and to the last one seen in either if some runs never complete; `None`: a sample is empty.
pub(super) fn comparable(first: &[Observation], second: &[Observation]) -> Option<Comparable> {
    let curves = [KaplanMeier::new(first)?, KaplanMeier::new(second)?];
    let reach = curves.iter().map(KaplanMeier::reach);
    let mut horizon = reach.fold(f64::INFINITY, f64::min);
    let mut all = first.iter().chain(second);
    if all.any(|run| run.status == Status::Competing) {
        // What never completes is known to do so for ever, and its mean has to end somewhere.
        horizon = horizon.min(curves[0].last().max(curves[1].last()));
    }
    let values = |curve: &KaplanMeier, sample: &[Observation]| {
        if sample
            .iter()
            .all(|run| run.is_completed() && run.time <= horizon)
        {
            // To the bit.
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

    /// What is known of runs that never complete is known for ever: times count up to the last that was seen in either sample, or to
    /// where one of them is not known any more.
    #[test]
    fn times_count_as_far_as_both_samples_are_known() {
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

    /// Of four runs none completes: up to 49 % of all might, by Wilson's interval.
    #[test]
    fn runs_that_never_complete_leave_open_how_many_would() {
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
