//! Clock for intervals, time limits and messages. Results never depend on it.
use std::time::Instant;

/// Returns the current time.
#[expect(
    clippy::disallowed_methods,
    reason = "no result of a run depends on it"
)]
pub fn now() -> Instant {
    Instant::now()
}
