//! Constraints of an optimization.
use serde::Serialize;

use super::{Objective, estimate};
use crate::{Estimate, Verdict};

/// Upper limit of a quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Constraint {
    /// Quantity with the limit.
    pub objective: Objective,
    /// Largest allowed value.
    pub limit: f64,
}

/// Error of reading a constraint.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error(
    "write `mean <= 5000` or `p90 <= 7000` with a time in ticks, or `P(T > 8000) <= 0.05` with a probability between 0 and 1"
)]
pub struct ConstraintError;

/// Constraint at the optimum.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConfirmedConstraint {
    /// Constraint as the user writes it.
    pub constraint: String,
    /// Value that the emulator predicts.
    pub predicted: Estimate,
    /// Value in runs with another seed. `None` if the sample has no value.
    pub confirmed: Option<Estimate>,
    /// Result of the runs with another seed.
    pub verdict: Verdict,
}

impl Constraint {
    /// Parses `p90 <= 7000` or another objective with a limit.
    ///
    /// # Errors
    ///
    /// If the text has another form, or the limit is impossible.
    pub fn parse(text: &str) -> Result<Constraint, ConstraintError> {
        let (objective, limit) = text.split_once("<=").ok_or(ConstraintError)?;
        let objective = Objective::parse(objective).map_err(|_| ConstraintError)?;
        let limit: f64 = limit.trim().parse().map_err(|_| ConstraintError)?;
        let is_probability = matches!(objective, Objective::Exceeds(_));
        let most = if is_probability { 1.0 } else { f64::INFINITY };
        let is_possible = limit > 0.0 && limit < most;
        is_possible
            .then_some(Constraint { objective, limit })
            .ok_or(ConstraintError)
    }

    /// Returns the constraint as the user writes it.
    pub fn name(self) -> String {
        format!("{} <= {}", self.objective.name(), self.limit)
    }

    /// Returns the time of the constraint \[ticks\]: the limit of a mean or quantile, or the time of
    /// a probability.
    pub fn time(self) -> f64 {
        match self.objective {
            Objective::Mean | Objective::Quantile(_) => self.limit,
            Objective::Exceeds(time) => time,
        }
    }

    /// Tests the constraint with the times of runs. A stopped run has the time `max_ticks`.
    ///
    /// A quantile is tested as the probability of longer times, because Wilson's interval is also
    /// valid for few runs. With stopped runs, the mean is a lower bound.
    pub fn verdict(self, times: &[f64], max_ticks: f64, seed: u64) -> Verdict {
        let (objective, limit) = match self.objective {
            Objective::Quantile(share) => (Objective::Exceeds(self.limit), 1.0 - share),
            other => (other, self.limit),
        };
        let is_bound = objective == Objective::Mean && times.iter().any(|time| *time >= max_ticks);
        match estimate(objective, times, seed) {
            Some(it) if it.low > limit => Verdict::Fails,
            Some(it) if it.high <= limit && !is_bound => Verdict::Holds,
            _ => Verdict::Undecided,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_constraints() {
        for text in ["mean <= 5000", "p90 <= 7000", "P(T > 8000) <= 0.05"] {
            assert_eq!(Constraint::parse(text).unwrap().name(), text);
        }
        let dense = Constraint::parse("P(T>8000)<=0.05").unwrap();
        assert_eq!(dense.objective, Objective::Exceeds(8000.0));
        assert_eq!((dense.limit, dense.time()), (0.05, 8000.0));
        for text in [
            "mean",
            "mean <= ",
            "mean < 5",
            "mean >= 5",
            "mean <= 0",
            "mean <= inf",
            "P(T > 8000) <= 1",
            "P(T > 8000) <= 0",
            "median <= 5",
        ] {
            assert_eq!(Constraint::parse(text), Err(ConstraintError), "{text}");
        }
    }

    #[test]
    fn verdicts_follow_the_interval() {
        use Verdict::{Fails, Holds, Undecided};
        let times: Vec<f64> = (1..=100).map(f64::from).collect();
        let verdict = |text: &str, max_ticks| {
            let constraint = Constraint::parse(text).unwrap();
            constraint.verdict(&times, max_ticks, 1)
        };
        for (text, expected) in [
            ("mean <= 60", Holds),
            ("mean <= 50", Undecided),
            ("mean <= 40", Fails),
            ("P(T > 90) <= 0.2", Holds),
            ("P(T > 90) <= 0.1", Undecided),
            ("P(T > 90) <= 0.04", Fails),
            ("p50 <= 65", Holds),
            ("p50 <= 50", Undecided),
            ("p50 <= 35", Fails),
            // No run is longer, but 100 runs cannot show that fewer than 1 % are.
            ("p99 <= 200", Undecided),
        ] {
            assert_eq!(verdict(text, 1000.0), expected, "{text}");
        }
        assert_eq!(verdict("mean <= 60", 100.0), Undecided);
        assert_eq!(verdict("mean <= 40", 100.0), Fails);
    }
}
