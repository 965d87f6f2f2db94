//! Error of rates for structures that were not part of their calibration.
use serde::{Deserialize, Serialize};
use stochc_text::percent;
use thiserror::Error;

/// Largest held-out error of rates that commands use.
pub const MAX_HELD_OUT_ERROR: f64 = 0.15;

/// Error of mean waiting times, by cross-validation over the structures of a calibration.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeldOut {
    /// Root mean square of the relative errors, without the part that sampling explains.
    pub error: f64,
    /// Root mean square of the errors that sampling alone would cause.
    pub sampling: f64,
}

/// Error of rates whose held-out error is too large.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "the rates of this scene have a held-out error of {} (sampling error {}), and at most {} is allowed; use `--model rigid`",
    percent(.0.error), percent(.0.sampling), percent(MAX_HELD_OUT_ERROR)
)]
pub struct InaccurateRates(pub HeldOut);

impl HeldOut {
    /// Returns whether commands may use the rates.
    pub(crate) fn is_accurate(&self) -> bool {
        self.error <= MAX_HELD_OUT_ERROR
    }
}
