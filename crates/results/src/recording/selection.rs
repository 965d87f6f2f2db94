//! Selection of runs to record.
use std::str::FromStr;

use thiserror::Error;

/// Selection of runs by number: `17`, `0..4` (both ends included), `0,5,10..12` or `all`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Selection {
    /// All runs.
    All,
    /// First and last run of each range.
    Ranges(Vec<(u64, u64)>),
}

impl Selection {
    /// Returns whether a run is selected.
    pub fn contains(&self, run: u64) -> bool {
        match self {
            Selection::All => true,
            Selection::Ranges(ranges) => {
                (ranges.iter()).any(|&(first, last)| (first..=last).contains(&run))
            }
        }
    }

    /// Returns the smallest selected run that is not among the first `runs`, if there is one.
    pub fn beyond(&self, runs: u64) -> Option<u64> {
        let Selection::Ranges(ranges) = self else {
            return None;
        };
        let beyond = ranges.iter().filter(|(_, last)| *last >= runs);
        beyond.map(|&(first, _)| first.max(runs)).min()
    }
}

/// Error of selecting runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum InvalidSelection {
    /// The text does not have the form of a selection.
    #[error("give runs as `17`, `0..4`, `0,5,10..12` or `all`")]
    Form,
    /// A range is empty.
    #[error("`{first}..{last}` ends before it begins")]
    Empty {
        /// First run of the range.
        first: u64,
        /// Last run of the range.
        last: u64,
    },
}

impl FromStr for Selection {
    type Err = InvalidSelection;

    fn from_str(text: &str) -> Result<Selection, InvalidSelection> {
        let number = |text: &str| text.trim().parse().map_err(|_| InvalidSelection::Form);
        if text == "all" {
            return Ok(Selection::All);
        }
        let parts = text.split(',').map(|part| match part.split_once("..") {
            None => number(part).map(|run| (run, run)),
            Some((first, last)) => {
                let (first, last) = (number(first)?, number(last)?);
                if first <= last {
                    Ok((first, last))
                } else {
                    Err(InvalidSelection::Empty { first, last })
                }
            }
        });
        parts.collect::<Result<_, _>>().map(Selection::Ranges)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_of_a_range_are_included() {
        let runs: Selection = "0, 5,10..12".parse().unwrap();
        let among: Vec<u64> = (0..20).filter(|&run| runs.contains(run)).collect();
        assert_eq!(among, [0, 5, 10, 11, 12]);
        assert!("all".parse::<Selection>().unwrap().contains(u64::MAX));
    }

    #[test]
    fn selections_beyond_the_runs_are_found() {
        let beyond = |text: &str| text.parse::<Selection>().unwrap().beyond(2);
        assert_eq!(beyond("all"), None);
        assert_eq!(beyond("0..1"), None);
        assert_eq!(beyond("0,9"), Some(9));
        assert_eq!(beyond("0..9"), Some(2));
        assert_eq!(beyond("12,7..8,1"), Some(7));
    }

    #[test]
    fn rejects_invalid_selections() {
        for text in ["", "x", "1..", "..2", "3..1", "-1", "1,,2", "0..2..4"] {
            assert!(text.parse::<Selection>().is_err(), "{text}");
        }
    }
}
