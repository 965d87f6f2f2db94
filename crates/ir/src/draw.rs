//! One time that chance has given a program, without a run.

/// A time to completion that was drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// What it took \[tick\].
    pub ticks: f64,
    /// Whether all phases were complete before their timeouts.
    pub is_complete: bool,
}
