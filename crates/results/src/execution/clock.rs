//! Clock for intervals, limits and messages, never for results.
use std::time::Instant;

/// Returns the current time.
#[expect(
    clippy::disallowed_methods,
    reason = "no result of a run depends on it"
)]
pub fn now() -> Instant {
    Instant::now()
}
