//! Statistics of times to completion: pure functions, no IO, no chance.
//!
//! A time may be *censored*: a run that was stopped at tick 40 000 says that its time to
//! completion is more than that, not that it is 40 000. [`Observation`] carries the difference,
//! and nothing here averages it away: where all times are known, [`Summary`] speaks, and where some
//! are censored, [`KaplanMeier`] does. [`compare`] holds two programs against each other.
mod difference;
mod distribution;
mod holm;
mod kolmogorov;
mod mean;
mod quantile;
mod ratio;
mod runs;
mod sample;
mod share;
mod summary;
mod survival;

pub(crate) use difference::correct;
pub use difference::{Difference, Longer, Test, compare};
use holm::holm;
pub(crate) use kolmogorov::{Distance, distance};
pub use mean::Mean;
pub use quantile::quantile;
pub use ratio::{Relative, relative};
pub use runs::Runs;
pub use sample::TimeSample;
pub(crate) use share::share_interval;
pub use summary::{Summary, median};
pub use survival::{KaplanMeier, RestrictedMean, SurvivalPoint};

/// A time, known or cut short.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// When the run completed, or was last seen incomplete, in any one unit; finite, not negative.
    pub time: f64,
    /// Whether the run completed then; `false`: the time is censored, the true one is longer.
    pub completed: bool,
}

impl Observation {
    /// A run that completed at `time`.
    pub const fn completed(time: f64) -> Observation {
        Observation {
            time,
            completed: true,
        }
    }

    /// A run that had not completed at `time`, when it was stopped.
    pub const fn censored(time: f64) -> Observation {
        Observation {
            time,
            completed: false,
        }
    }

    /// The time of a run that completed.
    pub fn completed_time(self) -> Option<f64> {
        self.completed.then_some(self.time)
    }
}
