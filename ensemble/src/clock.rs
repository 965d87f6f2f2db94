//! The command's clock: for how often to write and what to tell, never for results.
use std::time::Instant;

/// The time now.
#[expect(
    clippy::disallowed_methods,
    reason = "the command tells how long it takes; no result depends on it"
)]
pub(crate) fn now() -> Instant {
    Instant::now()
}
