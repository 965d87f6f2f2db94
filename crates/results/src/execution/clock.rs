//! The clock: for how often to write, how long to go on and what to tell, never for results.
use std::time::Instant;

/// The time now.
#[expect(
    clippy::disallowed_methods,
    reason = "no result of a run depends on it"
)]
pub fn now() -> Instant {
    Instant::now()
}
