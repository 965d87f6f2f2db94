//! Sampled completion time of a program, without a run.

/// Sampled completion time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draw {
    /// Completion time \[ticks\].
    pub ticks: f64,
    /// Whether all phases completed before their timeouts.
    pub is_complete: bool,
}
