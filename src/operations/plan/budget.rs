//! Budget of a search for plans: the options `--time` and `--tries`.
use std::time::Duration;

/// Limit on the search for better plans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// Limit on the time.
    Time(Duration),
    /// Limit on the number of plans.
    Tries(u64),
}

impl Budget {
    /// Returns a budget that takes about one second for a shape with `cells` cells.
    pub fn for_cells(cells: usize) -> Budget {
        /// Number of cells that the planner plans per second.
        const IN_A_SECOND: usize = 300_000;
        Budget::Tries((IN_A_SECOND / cells.max(1)).clamp(1, 3000) as u64)
    }

    /// Returns the largest number of plans that the budget allows.
    pub fn tries(self) -> u64 {
        match self {
            Budget::Time(_) => u64::MAX,
            Budget::Tries(tries) => tries,
        }
    }

    /// Returns the fraction of the budget that has been used.
    pub fn share(self, tried: u64, elapsed: Duration) -> f64 {
        let share = match self {
            Budget::Time(time) => elapsed.as_secs_f64() / time.as_secs_f64(),
            Budget::Tries(tries) => tried as f64 / tries as f64,
        };
        share.min(1.0)
    }
}
