//! Statistics of times to completion: pure functions, no IO, no chance.
//!
//! A time may be *censored*: a run that was stopped at tick 40 000 says that its time to
//! completion is more than that, not that it is 40 000. [`Observation`] carries the difference,
//! and nothing here averages it away: where all times are known, [`Summary`] and Welch's test
//! speak; where some are censored, [`KaplanMeier`] and the log-rank test do.
mod difference;
mod distribution;
mod holm;
mod kolmogorov;
mod paired;
mod quantile;
mod ratio;
mod share;
mod summary;
mod survival;

pub use difference::{Difference, Test, compare};
pub use holm::holm;
pub use kolmogorov::{Distance, distance};
pub use paired::{Paired, paired};
pub use quantile::quantile;
pub use ratio::{Relative, relative};
pub use share::share_interval;
pub use summary::{Summary, median};
pub use survival::{KaplanMeier, Point, RestrictedMean};

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
}
