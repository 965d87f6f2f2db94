//! Numbers, percentages and times.
mod duration;
mod number;
mod percent;
mod ranges;

pub use duration::{DurationError, Tick, duration, seconds, words};
pub use number::{interval, number, ratio};
pub use percent::{ShareError, percent, percent_number, share, whole_percent};
pub use ranges::ranges;
