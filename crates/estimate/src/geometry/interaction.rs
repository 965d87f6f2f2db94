//! Errors that are known for sums of waiting times.
use serde::Serialize;

/// Effect of waiting captures of a program on each other. Adding waiting times along the graph
/// neglects this effect. A program has the strongest effect that its captures have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Interaction {
    /// Open faces are never near each other at the same time, and no block is released.
    Apart,
    /// Blocks are released, and may dock at an open face nearby.
    Releases,
    /// Adjacent faces are open at the same time, and their order is random.
    Racing,
}

impl Interaction {
    /// Returns the largest measured error of a mean relative to runs with the same rates
    /// (docs/validation/rates.md).
    pub fn error(self) -> f64 {
        match self {
            Interaction::Apart => 0.016,
            Interaction::Releases => 0.06,
            Interaction::Racing => 0.12,
        }
    }

    /// Returns the interaction as part of a sentence.
    pub fn meaning(self) -> &'static str {
        match self {
            Interaction::Apart => "no adjacent faces are open together, and no block is released",
            Interaction::Releases => "blocks are released, and may dock nearby",
            Interaction::Racing => "adjacent faces are open together",
        }
    }
}
