//! What runs gain if the rest of them is planned anew where nothing docks for long.
use serde::Serialize;
use stochc_ensemble::statistics::{Difference, Observation, Runs, compare};
use stochc_ensemble::{Time, last_seen};

/// The runs of a program, as they are and with plans in between.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Replanning {
    /// What the program is called.
    pub program: String,
    /// Ticks without a docking or a release after which the rest is planned anew.
    pub after: u64,
    /// Runs that were compared; those that failed are not.
    pub runs: usize,
    /// Plans that were made, of all runs.
    pub plans: u64,
    /// Runs in which the rest could not be planned, and which went on as they were.
    pub not_planned: u64,
    /// Releases of the program. A plan captures nothing that is let go again, so that where there are any it has less to do.
    pub releases: usize,
    /// Ticks to completion of the runs as they are.
    pub plain: Option<Time>,
    /// The same with the plans.
    pub replanned: Option<Time>,
    /// The first less the second, in ticks.
    pub difference: Option<Difference>,
}

impl Replanning {
    /// Of pairs of times, in ticks, by the number of the run.
    pub fn of(
        program: &str,
        after: u64,
        times: &[(u64, [Observation; 2])],
        (plans, not_planned): (u64, u64),
        releases: usize,
    ) -> Replanning {
        // Until the first plan they are the same, so that they belong together in pairs.
        let side = |side: usize| -> Vec<(u64, Observation)> {
            times.iter().map(|(run, pair)| (*run, pair[side])).collect()
        };
        let [plain, replanned] = [side(0), side(1)].map(|times| Runs::of(0, times, 1.0));
        let last = last_seen(times.iter().flat_map(|(_, pair)| *pair));
        Replanning {
            program: program.to_owned(),
            after,
            runs: times.len(),
            plans,
            not_planned,
            releases,
            plain: Time::beside(&plain.observations(), last),
            replanned: Time::beside(&replanned.observations(), last),
            difference: compare(&plain, &replanned),
        }
    }

    /// Whether so many runs completed, as they are and with plans.
    pub fn are_complete(&self, runs: u64) -> bool {
        let completed = |time: &Option<Time>| time.as_ref().map_or(0, |time| time.completed);
        let both = [&self.plain, &self.replanned].map(completed);
        both.iter().all(|completed| *completed as u64 == runs)
    }
}
