//! Numbers, shares and times as people read them, and names of others as what they are.
mod duration;
mod number;
mod percent;
mod ranges;
mod visible;

pub use duration::{Tick, duration, seconds, words};
pub use number::{number, ratio};
pub use percent::{percent, percent_number, relative, relative_size, share, whole_percent};
pub use ranges::ranges;
pub use visible::{escaped, visible};
