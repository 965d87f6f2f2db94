//! Objectives of an optimization.
use statrs::distribution::{ContinuousCDF as _, Normal};

/// Quantity to minimize.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Objective {
    /// Mean completion time.
    Mean,
    /// Quantile of the completion time, for this share of the runs.
    Quantile(f64),
    /// Probability that a run takes longer than this time \[ticks\].
    Exceeds(f64),
}

/// Error of reading an objective.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error(
    "write `mean`, a quantile such as `p90`, or a probability such as `P(T > 8000)` with a time in ticks"
)]
pub struct ObjectiveError;

impl Objective {
    /// Parses `mean`, `p90` or `P(T > 8000)`.
    ///
    /// # Errors
    ///
    /// If the text has another form.
    pub fn parse(text: &str) -> Result<Objective, ObjectiveError> {
        let text: String = text.split_whitespace().collect();
        if text == "mean" {
            return Ok(Objective::Mean);
        }
        let time = text
            .strip_prefix("P(T>")
            .and_then(|it| it.strip_suffix(')'));
        if let Some(time) = time {
            let time: Option<f64> = time.parse().ok();
            let time = time.filter(|it| it.is_finite() && *it > 0.0);
            return time.map(Objective::Exceeds).ok_or(ObjectiveError);
        }
        let percent: Option<u8> = text.strip_prefix('p').and_then(|it| it.parse().ok());
        let percent = percent.filter(|it| (1..=99).contains(it));
        let share = percent.map(|it| f64::from(it) / 100.0);
        share.map(Objective::Quantile).ok_or(ObjectiveError)
    }

    /// Returns the objective as the user writes it.
    pub fn name(self) -> String {
        match self {
            Objective::Mean => "mean".to_owned(),
            Objective::Quantile(share) => format!("p{:.0}", 100.0 * share),
            Objective::Exceeds(time) => format!("P(T > {time})"),
        }
    }

    /// Returns the score of times with these logarithms of mean and standard deviation. The score
    /// increases with the objective and is nearly normally distributed.
    ///
    /// Quantiles and probabilities are those of a log-normal distribution.
    pub(crate) fn score(self, values: &[f64]) -> f64 {
        let (log_mean, log_sd) = (values[0], values[1]);
        let variance = (2.0 * (log_sd - log_mean)).exp().ln_1p();
        let middle = log_mean - variance / 2.0;
        match self {
            Objective::Mean => log_mean,
            Objective::Quantile(share) => {
                middle + variance.sqrt() * Normal::standard().inverse_cdf(share)
            }
            Objective::Exceeds(time) => (middle - time.ln()) / variance.sqrt(),
        }
    }

    /// Returns the variance of the score for these variances of the two logarithms.
    pub(crate) fn score_variance(self, values: &[f64], variances: &[f64]) -> f64 {
        const STEP: f64 = 1e-4;
        let slope = |i: usize| {
            let mut moved = [values[0], values[1]];
            moved[i] += STEP;
            (self.score(&moved) - self.score(values)) / STEP
        };
        (0..2).map(|i| slope(i).powi(2) * variances[i]).sum()
    }

    /// Returns the value of the objective for a score.
    pub(crate) fn value(self, score: f64) -> f64 {
        match self {
            Objective::Mean | Objective::Quantile(_) => score.exp(),
            Objective::Exceeds(_) => Normal::standard().cdf(score),
        }
    }

    /// Returns the score for a value of the objective.
    pub(crate) fn score_of(self, value: f64) -> f64 {
        match self {
            Objective::Mean | Objective::Quantile(_) => value.ln(),
            Objective::Exceeds(_) => Normal::standard().inverse_cdf(value),
        }
    }

    /// Returns the objective of a sample. Each time has a weight. Returns `None` if all weights are
    /// 0.
    pub(crate) fn of_sample(self, sample: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
        let mut sample: Vec<(f64, f64)> = sample.filter(|(_, weight)| *weight > 0.0).collect();
        let total: f64 = sample.iter().map(|(_, weight)| weight).sum();
        match self {
            _ if sample.is_empty() => None,
            Objective::Mean => Some(
                sample
                    .iter()
                    .map(|(time, weight)| time * weight)
                    .sum::<f64>()
                    / total,
            ),
            Objective::Exceeds(limit) => {
                let longer = sample.iter().filter(|(time, _)| *time > limit);
                Some(longer.map(|(_, weight)| weight).sum::<f64>() / total)
            }
            Objective::Quantile(share) => {
                sample.sort_by(|a, b| a.0.total_cmp(&b.0));
                let mut sum = 0.0;
                let reached = sample.iter().find(|(_, weight)| {
                    sum += weight;
                    sum >= share * total
                });
                reached.or(sample.last()).map(|(time, _)| *time)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_objectives() {
        for (text, objective) in [
            ("mean", Objective::Mean),
            ("p90", Objective::Quantile(0.9)),
            ("P(T > 8000)", Objective::Exceeds(8000.0)),
        ] {
            assert_eq!(Objective::parse(text), Ok(objective));
            assert_eq!(objective.name(), text);
        }
        for text in [
            "",
            "p",
            "p0",
            "p100",
            "median",
            "P(T > )",
            "P(T > -1)",
            "P(T > inf)",
        ] {
            assert_eq!(Objective::parse(text), Err(ObjectiveError), "{text}");
        }
    }

    /// Checks the scores against quantiles and probabilities of a log-normal distribution.
    #[test]
    fn scores_are_those_of_a_log_normal_distribution() {
        use statrs::distribution::LogNormal;
        use statrs::statistics::Distribution as _;
        let law = LogNormal::new(6.0, 0.7).unwrap();
        let values = [law.mean().unwrap().ln(), law.std_dev().unwrap().ln()];
        for (objective, expected) in [
            (Objective::Mean, law.mean().unwrap()),
            (Objective::Quantile(0.9), law.inverse_cdf(0.9)),
            (Objective::Exceeds(700.0), law.sf(700.0)),
        ] {
            let found = objective.value(objective.score(&values));
            assert!(
                (found / expected - 1.0).abs() < 1e-4,
                "{objective:?} {found} {expected}"
            );
            let back = objective.value(objective.score_of(found));
            assert!((back / found - 1.0).abs() < 1e-9, "{objective:?} {back}");
        }
    }

    #[test]
    fn a_weight_counts_like_copies_of_a_time() {
        let weighted = [(5.0, 2.0), (1.0, 1.0), (9.0, 0.0), (3.0, 1.0)];
        let copies = [5.0, 5.0, 1.0, 3.0];
        for objective in [
            Objective::Mean,
            Objective::Quantile(0.4),
            Objective::Exceeds(3.0),
        ] {
            let copies = objective.of_sample(copies.into_iter().map(|it| (it, 1.0)));
            assert!(copies.is_some());
            assert_eq!(objective.of_sample(weighted.into_iter()), copies);
        }
        assert_eq!(Objective::Mean.of_sample([(1.0, 0.0)].into_iter()), None);
    }
}
