//! Limits of the search for access paths.
use stochc_grammar::Cancellation;

/// Number of searched positions, and its limit.
pub(super) struct SearchEffort<'a> {
    pub(super) steps: u64,
    pub(super) budget: u64,
    pub(super) cancellation: Cancellation<'a>,
}

impl SearchEffort<'_> {
    /// Returns whether the limit is reached or the check was cancelled.
    pub(super) fn is_spent(&self) -> bool {
        self.steps > self.budget || self.cancellation.is_cancelled()
    }
}
