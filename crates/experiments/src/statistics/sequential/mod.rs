//! Sequential tests: their error bounds are valid at every number of runs, so that a test may stop
//! as soon as it decides.
//!
//! Each value is a range from the smallest to the largest possible value. For a run that was
//! stopped, both ends differ. A limit uses the end that makes it wider.
mod mean;
mod share;

pub use mean::MeanTest;
pub use share::ShareTest;

/// Position of an unknown parameter relative to a bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The parameter is above the bound.
    Above,
    /// The parameter is below the bound.
    Below,
}
