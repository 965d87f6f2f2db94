//! Statistics of completion times: pure functions without I/O and random numbers.
//!
//! A time may be *censored*: the completion time of a run that was stopped at tick 40 000 is longer
//! than that. A run that timed out in a phase never completes. [`Observation`] distinguishes these
//! cases. [`Summary`] is for complete times, [`KaplanMeier`] for incomplete ones. [`compare`]
//! compares two programs.
mod convolution;
mod difference;
mod distribution;
mod holm;
mod mean;
mod observation;
mod quantile;
mod ratio;
mod runs;
mod sample;
mod sequential;
mod share;
mod summary;
mod survival;

pub(crate) use convolution::SumDistribution;
pub(crate) use difference::correct;
pub use difference::{Difference, Longer, SIGNIFICANT, Test, compare};
pub use mean::Mean;
pub use observation::{Observation, Status};
pub use quantile::quantile;
pub use ratio::{Relative, relative};
pub use runs::Runs;
pub use sample::TimeSample;
pub use sequential::{MeanTest, ShareTest, Side};
pub(crate) use share::share_interval;
pub use summary::{Summary, median};
pub use survival::{KaplanMeier, SurvivalPoint};
