//! Cancellation of work, if its result is not needed any more.
use std::fmt;

/// Function that returns whether long work should be cancelled.
///
/// The work calls it about once per event, so it should cost no more than reading an atomic.
#[derive(Clone, Copy)]
pub struct Cancellation<'a>(&'a dyn Fn() -> bool);

/// Error of cancelled work, which has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

impl<'a> Cancellation<'a> {
    /// Cancellation that never occurs: the work always continues.
    pub const NEVER: Cancellation<'static> = Cancellation(&|| false);

    /// Creates a cancellation. The work ends soon after `is_cancelled` has returned true.
    /// `is_cancelled` must then return true forever.
    pub fn new(is_cancelled: &'a dyn Fn() -> bool) -> Cancellation<'a> {
        Cancellation(is_cancelled)
    }

    /// Returns whether the work should stop.
    pub fn is_cancelled(self) -> bool {
        self.0()
    }

    /// Checks whether the work should continue.
    ///
    /// # Errors
    ///
    /// Returns [`Cancelled`] if the work should stop.
    pub fn check(self) -> Result<(), Cancelled> {
        if self.is_cancelled() {
            Err(Cancelled)
        } else {
            Ok(())
        }
    }
}

impl fmt::Debug for Cancellation<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Cancellation({})", self.is_cancelled())
    }
}
