//! Goal of an optimization.
use super::{Constraint, Objective};
use crate::fit::EmulatorPrediction;

/// Quantity to minimize, and the constraints that the optimum satisfies.
#[derive(Clone, Copy, Debug)]
pub struct Goal<'a> {
    /// Quantity to minimize.
    pub objective: Objective,
    /// Constraints.
    pub constraints: &'a [Constraint],
}

/// Score that cannot be distinguished from that of the optimum, or from the limit of a constraint.
#[derive(Clone, Copy, Debug)]
pub(super) struct ScoreBound {
    objective: Objective,
    score: f64,
    /// Standard error of the score at the optimum.
    error: f64,
}

impl Goal<'_> {
    /// Returns the rank of a point with these predicted values. The best point has the smallest rank:
    /// the sum of the scores above the limits of constraints, and then the score of the objective.
    pub(super) fn rank(&self, values: &[f64]) -> (f64, f64) {
        let excess = |it: &Constraint| {
            let limit = it.objective.score_of(it.limit);
            (it.objective.score(values) - limit).max(0.0)
        };
        let excess = self.constraints.iter().map(excess).fold(0.0, |a, b| a + b);
        (excess, self.objective.score(values))
    }

    /// Returns bounds of the scores of points that cannot be distinguished from the optimum, for the
    /// prediction at the optimum. If no point satisfies the constraints, the objective has no bound.
    pub(super) fn bounds(&self, optimum: &EmulatorPrediction) -> Vec<ScoreBound> {
        let (values, variance) = (&optimum.values, &optimum.variance);
        let bound = |objective: Objective, least: f64| ScoreBound {
            objective,
            score: objective.score(values).max(least),
            error: objective.score_variance(values, variance).sqrt().max(1e-6),
        };
        let constraints = self.constraints.iter();
        let constraints =
            constraints.map(|it| bound(it.objective, it.objective.score_of(it.limit)));
        let is_feasible = self.rank(values).0 <= 0.0;
        let objective = is_feasible.then(|| bound(self.objective, f64::NEG_INFINITY));
        objective.into_iter().chain(constraints).collect()
    }
}

impl ScoreBound {
    /// Returns the logarithm of the likelihood that a point with these values is within the bound.
    pub(super) fn log_likelihood(&self, values: &[f64]) -> f64 {
        let excess = (self.objective.score(values) - self.score).max(0.0);
        -0.5 * (excess / self.error).powi(2)
    }
}
