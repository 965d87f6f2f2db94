//! Statistics of times to completion: pure functions, no IO, no chance.
//!
//! A time may be *censored*: a run that was stopped at tick 40 000 says that its time to
//! completion is more than that, not that it is 40 000. A run that the timeout of a phase has ended
//! says more: it never completes. [`Observation`] carries the difference,
//! and nothing here averages it away: where all times are known, [`Summary`] speaks, and where some
//! are not, [`KaplanMeier`] does. [`compare`] holds two programs against each other.
mod difference;
mod distribution;
mod holm;
mod mean;
mod quantile;
mod ratio;
mod runs;
mod sample;
mod share;
mod summary;
mod survival;

pub(crate) use difference::correct;
pub use difference::{Difference, Longer, SIGNIFICANT, Test, compare};
use holm::holm;
pub use mean::Mean;
pub use quantile::quantile;
pub use ratio::{Relative, relative};
pub use runs::Runs;
pub use sample::TimeSample;
pub(crate) use share::share_interval;
pub use summary::{Summary, median};
pub use survival::{KaplanMeier, SurvivalPoint};

/// A time, known or cut short.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// When the run completed, or was last seen incomplete, in any one unit; finite, not negative.
    pub time: f64,
    /// What happened then.
    pub status: Status,
}

/// What happened at the time of an observation, as survival analysis has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The run completed.
    Completed,
    /// It was stopped for a reason that has nothing to do with it: the true time is longer.
    Censored,
    /// An event after which it cannot complete any more (a competing event): the true time is infinite.
    Competing,
}

impl Observation {
    /// A run that completed at `time`.
    pub const fn completed(time: f64) -> Observation {
        Observation {
            time,
            status: Status::Completed,
        }
    }

    /// A run that had not completed at `time`, when it was stopped.
    pub const fn censored(time: f64) -> Observation {
        Observation {
            time,
            status: Status::Censored,
        }
    }

    /// A run that was ended at `time` by what is part of its program, so that it never completes.
    pub const fn competing(time: f64) -> Observation {
        Observation {
            time,
            status: Status::Competing,
        }
    }

    /// Whether the run completed.
    pub fn is_completed(self) -> bool {
        self.status == Status::Completed
    }

    /// Up to when it counts among those that may still complete later: for ever, if it never completes.
    pub fn at_risk_until(self) -> f64 {
        match self.status {
            Status::Completed | Status::Censored => self.time,
            Status::Competing => f64::INFINITY,
        }
    }

    /// The time of a run that completed.
    pub fn completed_time(self) -> Option<f64> {
        self.is_completed().then_some(self.time)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Times of all kinds, of which most are completed.
    pub(crate) fn observation(times: std::ops::Range<u32>) -> impl Strategy<Value = Observation> {
        let status = prop_oneof![
            3 => Just(Status::Completed),
            1 => Just(Status::Censored),
            1 => Just(Status::Competing),
        ];
        (times, status).prop_map(|(time, status)| Observation {
            time: time.into(),
            status,
        })
    }
}
