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
    "the rates of this scene have a held-out error of {} (sampling error {}), and at most {} is allowed; use `--model rigid`{}",
    percent(.0.error), percent(.0.sampling), percent(MAX_HELD_OUT_ERROR), .0.advice()
)]
pub struct InaccurateRates(pub HeldOut);

impl HeldOut {
    /// Returns whether commands may use the rates.
    pub(crate) fn is_accurate(&self) -> bool {
        self.error <= MAX_HELD_OUT_ERROR
    }

    /// Returns a further way out, if more captures can change the held-out error considerably.
    fn advice(&self) -> &'static str {
        if self.sampling > self.error / 2.0 {
            ", or calibrate with more runs (`--runs`)"
        } else {
            ""
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_runs_are_advised_only_if_the_sampling_error_is_large() {
        let advised = |error, sampling| {
            InaccurateRates(HeldOut { error, sampling })
                .to_string()
                .contains("`--runs`")
        };
        assert!(advised(0.2, 0.15));
        assert!(!advised(0.3, 0.05));
    }
}
