//! Numbers, shares and times as people read them, and names of others as what they are.
mod duration;
mod number;
mod percent;
mod ranges;
mod visible;

pub use duration::{Tick, duration, seconds, words};
pub use number::{number, ratio};
pub use percent::{percent, relative, relative_size};
pub use ranges::ranges;
pub use visible::{escaped, visible};
