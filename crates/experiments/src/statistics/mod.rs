//! Statistics of completion times: pure functions without I/O and random numbers.
//!
//! A time may be *censored*: a run stopped at tick 40 000 has a longer completion time, not 40 000.
//! A run that timed out in a phase never completes. [`Observation`] distinguishes these cases.
//! [`Summary`] is for complete times, [`KaplanMeier`] for incomplete ones. [`compare`] compares two
//! programs.
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

/// Time of a run, possibly incomplete.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Time of completion or of the last observation, in any unit; finite and not negative.
    pub time: f64,
    /// Status at that time.
    pub status: Status,
}

/// Status at the time of an observation, as in survival analysis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The run completed.
    Completed,
    /// The run was stopped for an unrelated reason. The true time is longer.
    Censored,
    /// The run ended by a competing event and can never complete. The true time is infinite.
    Competing,
}

impl Observation {
    /// Returns a run that completed at `time`.
    pub const fn completed(time: f64) -> Observation {
        Observation {
            time,
            status: Status::Completed,
        }
    }

    /// Returns a run that was censored at `time`.
    pub const fn censored(time: f64) -> Observation {
        Observation {
            time,
            status: Status::Censored,
        }
    }

    /// Returns a run that ended at `time` by its program, so that it never completes.
    pub const fn competing(time: f64) -> Observation {
        Observation {
            time,
            status: Status::Competing,
        }
    }

    /// Returns whether the run completed.
    pub fn is_completed(self) -> bool {
        self.status == Status::Completed
    }

    /// Returns the end of the time at risk. Infinite if the run never completes.
    pub fn at_risk_until(self) -> f64 {
        match self.status {
            Status::Completed | Status::Censored => self.time,
            Status::Competing => f64::INFINITY,
        }
    }

    /// Returns the time of a completed run.
    pub fn completed_time(self) -> Option<f64> {
        self.is_completed().then_some(self.time)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Times of all kinds, mostly completed.
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
