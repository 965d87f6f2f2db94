//! Result of the search for scaffolds.
use std::fmt;

use serde::Serialize;

/// Largest target that is searched for scaffolds \[cells\].
pub(super) const MAX_CELLS: usize = 300;

/// Result of the search for scaffolds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "outcome", rename_all = "snake_case")]
pub enum ScaffoldTrial {
    /// Scaffolds were not tried.
    NotTried {
        /// Reason for not trying scaffolds.
        reason: NoScaffolds,
    },
    /// Scaffolds were tried.
    Tried {
        /// Estimate of the best plan without scaffolds \[ticks\].
        without: f64,
        /// Estimate of the best plan with scaffolds \[ticks\].
        with: f64,
        /// Whether the plan uses scaffolds.
        is_used: bool,
    },
}

/// Reason why scaffolds were not tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum NoScaffolds {
    /// This kind of plan excludes scaffolds.
    NotWanted,
    /// There are pre-attached blocks.
    BlocksStand,
    /// No block of the plate is available for a mast.
    NoPlace,
    /// The target has too many cells.
    TooLarge,
    /// The target uses all free blocks.
    NoSpareBlocks,
    /// Every face always attracts.
    AttractsAlways,
    /// The search makes too few tries.
    FewTries,
    /// No removable scaffold was found.
    NoneFound,
}

impl ScaffoldTrial {
    /// Returns the result for a plan without scaffolds.
    #[must_use]
    pub fn unused(self) -> ScaffoldTrial {
        match self {
            ScaffoldTrial::Tried { without, with, .. } => ScaffoldTrial::Tried {
                without,
                with,
                is_used: false,
            },
            other => other,
        }
    }
}

impl NoScaffolds {
    fn words(self) -> String {
        match self {
            NoScaffolds::NotWanted => "this kind of plan has none".to_owned(),
            NoScaffolds::BlocksStand => "blocks stand already".to_owned(),
            NoScaffolds::NoPlace => {
                "the plate has no room for them, a larger plate has (`--plate`)".to_owned()
            }
            NoScaffolds::TooLarge => format!("the target has more than {MAX_CELLS} cells"),
            NoScaffolds::NoSpareBlocks => "the target takes all free blocks (`--free`)".to_owned(),
            NoScaffolds::AttractsAlways => "every face attracts all the time".to_owned(),
            NoScaffolds::FewTries => "the search makes too few tries (`--tries`)".to_owned(),
            NoScaffolds::NoneFound => "no place was found for any".to_owned(),
        }
    }
}

impl fmt::Display for ScaffoldTrial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ScaffoldTrial::NotTried { reason } => {
                write!(f, "scaffolds: not tried, {}", reason.words())
            }
            ScaffoldTrial::Tried {
                without,
                with,
                is_used,
            } => {
                let verb = if *is_used {
                    "used"
                } else {
                    "tried and not used"
                };
                let gain = 100.0 * (without - with) / without;
                write!(
                    f,
                    "scaffolds: {verb}, {with:.0} ticks with them and {without:.0} without, a gain of {gain:.1} %"
                )
            }
        }
    }
}
