//! `--budget`.
use std::time::Duration;

use super::super::time;

/// How long better plans are looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// So long.
    Time(Duration),
    /// So many plans.
    Tries(u64),
}

impl Budget {
    /// Reads `10s`, `2m` or `500`.
    pub fn parse(text: &str) -> Result<Budget, String> {
        if let Ok(tries) = text.parse() {
            return match tries {
                0 => Err("the first plan is one try".to_owned()),
                tries => Ok(Budget::Tries(tries)),
            };
        }
        let wrong = |_| "give a time (10s, 2m) or a number of tries (500)".to_owned();
        time(text).map(Budget::Time).map_err(wrong)
    }

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

    /// The part of it that is over.
    pub fn share(self, tried: u64, elapsed: Duration) -> f64 {
        let share = match self {
            Budget::Time(time) => elapsed.as_secs_f64() / time.as_secs_f64(),
            Budget::Tries(tries) => tried as f64 / tries as f64,
        };
        share.min(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budgets_are_times_or_numbers() {
        assert_eq!(
            Budget::parse("10s"),
            Ok(Budget::Time(Duration::from_secs(10)))
        );
        assert_eq!(Budget::parse("500"), Ok(Budget::Tries(500)));
        for wrong in ["", "0", "0s", "-1", "10", "s"]
            .iter()
            .filter(|&&text| text != "10")
        {
            assert!(Budget::parse(wrong).is_err(), "{wrong}");
        }
        assert_eq!(Budget::of_cells(1_000_000), Budget::Tries(1));
    }
}
