//! How far sums of waits are known to be off.
use serde::Serialize;

/// What the captures of a program have to do with each other while they wait. Waits that are added up along its graph leave some of it
/// out, and this says how much; the worst of a program counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Interaction {
    /// No two open faces are near each other at the same time, and nothing is released.
    Apart,
    /// Blocks are released, and may dock at an open face nearby.
    Releases,
    /// Faces wait beside each other, and nobody knows which captures first.
    Racing,
}

impl Interaction {
    /// The largest error of a mean beside runs by the same rates, of those that were measured (docs/validation/rates.md).
    pub fn error(self) -> f64 {
        match self {
            Interaction::Apart => 0.016,
            Interaction::Releases => 0.06,
            Interaction::Racing => 0.12,
        }
    }

    /// The same as a clause about the captures of a program.
    pub fn meaning(self) -> &'static str {
        match self {
            Interaction::Apart => "no faces wait beside each other, and no block is released",
            Interaction::Releases => "blocks are released, and may dock nearby",
            Interaction::Racing => "faces wait beside each other",
        }
    }
}
