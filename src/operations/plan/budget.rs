//! `--time` and `--tries`.
use std::time::Duration;

/// How long better plans are looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// So long.
    Time(Duration),
    /// So many plans.
    Tries(u64),
}

impl Budget {
    /// What takes about a second for so many cells.
    pub fn of_cells(cells: usize) -> Budget {
        /// Cells for which a plan is tried in a second.
        const IN_A_SECOND: usize = 300_000;
        Budget::Tries((IN_A_SECOND / cells.max(1)).clamp(1, 3000) as u64)
    }

    /// Plans that are tried, at most.
    pub fn tries(self) -> u64 {
        match self {
            Budget::Time(_) => u64::MAX,
            Budget::Tries(tries) => tries,
        }
    }

    /// Returns the part of it that is over.
    pub fn share(self, tried: u64, elapsed: Duration) -> f64 {
        let share = match self {
            Budget::Time(time) => elapsed.as_secs_f64() / time.as_secs_f64(),
            Budget::Tries(tries) => tried as f64 / tries as f64,
        };
        share.min(1.0)
    }
}
