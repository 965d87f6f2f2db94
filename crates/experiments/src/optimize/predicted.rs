//! Optimum that the emulator predicts.
use serde::Serialize;

use super::{ConfirmedConstraint, Constraint, Goal, Objective};
use crate::fit::{Emulator, Marginal, Posterior, Prior, Simulated};
use crate::{Estimate, Verdict};

/// Quantile of the standard normal distribution for a 95 % interval.
const NORMAL: f64 = 1.959_963_984_540_054;

/// Times above this multiple of the smallest mean are compressed.
const LONG: f64 = 6.0;

/// Power of the compression.
const COMPRESSION: f64 = 0.1;

/// Number of intervals of a coordinate in the search for the minimum.
const STEPS: u32 = 40;

/// Largest number of passes over all coordinates.
const PASSES: usize = 30;

/// Optimum of a program.
#[derive(Clone, Debug, Serialize)]
pub struct Optimum {
    /// Name of the program.
    pub program: String,
    /// Objective as the user writes it.
    pub objective: String,
    /// Optimal value of each parameter.
    pub numbers: Vec<OptimalNumber>,
    /// Value of the objective that the emulator predicts.
    pub predicted: Estimate,
    /// Value of the objective in runs with another seed. `None` if the sample has no value.
    pub confirmed: Option<Estimate>,
    /// Constraints, in the order of the command line.
    pub constraints: Vec<ConfirmedConstraint>,
    /// Whether the prediction satisfies all constraints. Otherwise no point does, and this one is
    /// nearest to the limits.
    pub feasible: bool,
    /// Point of the search with the smallest objective, without regard to constraints.
    pub best_simulated: BestSimulated,
    /// Number of simulated points, without the confirmation.
    pub points: usize,
    /// Number of runs at these points.
    pub runs: usize,
    /// Number of runs that confirm the optimum.
    pub confirming: u64,
    /// Number of runs of the search that did not complete.
    pub stopped: usize,
    /// Number of runs at the optimum and at its neighbours that did not complete.
    pub stopped_confirming: usize,
}

impl Optimum {
    /// Returns whether the runs with another seed satisfy all constraints. If they do not decide,
    /// the prediction does.
    pub fn satisfies_constraints(&self) -> bool {
        let mut verdicts = self.constraints.iter().map(|it| it.verdict);
        verdicts.all(|it| it == Verdict::Holds || it == Verdict::Undecided && self.feasible)
    }
}

/// Point of the search with the smallest objective in its own runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BestSimulated {
    /// Value of each parameter.
    pub numbers: Vec<f64>,
    /// Objective in the runs at this point. Stopped runs count as in the search.
    pub value: f64,
    /// Number of runs at this point.
    pub runs: usize,
}

impl BestSimulated {
    /// Returns the best point. `points` has at least one point.
    pub fn new(points: &[Simulated], priors: &[Prior], objective: Objective) -> BestSimulated {
        let value = |point: &Simulated| {
            let sample = point.times.iter().map(|time| (*time, 1.0));
            objective.of_sample(sample).unwrap_or(f64::INFINITY)
        };
        let best = points.iter().min_by(|a, b| value(a).total_cmp(&value(b)));
        let best = best.expect("a search simulates points");
        let numbers = best.at.iter().zip(priors);
        BestSimulated {
            numbers: numbers.map(|(at, prior)| prior.rounded(*at)).collect(),
            value: value(best),
            runs: best.times.len(),
        }
    }
}

/// Optimal value of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OptimalNumber {
    /// Optimal value.
    pub value: f64,
    /// Values that the emulator cannot distinguish from the optimum.
    pub similar: Marginal,
    /// Elasticity of the objective. `None` if it is unknown or a value is 0.
    pub elasticity: Option<Estimate>,
}

/// Minimum of the objective in a box, within constraints, predicted by the emulator.
#[derive(Clone, Debug)]
pub struct PredictedOptimum {
    /// Coordinates of the optimum. Each is a cumulative probability of the prior of one parameter.
    pub at: Vec<f64>,
    /// Predicted value of the objective, with its 95 % interval.
    pub value: Estimate,
    /// Predicted value of each constraint, with its 95 % interval.
    pub constraints: Vec<Estimate>,
    /// Whether the predicted values satisfy all constraints.
    pub is_feasible: bool,
    /// Points that the emulator cannot distinguish from the optimum.
    pub similar: Posterior,
}

impl PredictedOptimum {
    /// Returns the optimum in a box with these ends. `common` is the number of runs with different
    /// random numbers: runs at different points share them.
    ///
    /// Returns `None` if the box contains too few points.
    pub fn new(
        points: &[Simulated],
        ends: &[(f64, f64)],
        priors: &[Prior],
        goal: Goal<'_>,
        common: f64,
        seed: u64,
    ) -> Option<PredictedOptimum> {
        let horizon = horizon(points, goal)?;
        let constraints: Vec<Constraint> = (goal.constraints.iter())
            .map(|it| match it.objective {
                Objective::Exceeds(_) => *it,
                Objective::Mean | Objective::Quantile(_) => Constraint {
                    limit: compressed(it.limit, horizon),
                    ..*it
                },
            })
            .collect();
        let goal = Goal {
            constraints: &constraints,
            ..goal
        };
        let near = points.iter().filter(|point| point.is_within(ends));
        let near: Vec<Simulated> = near.map(|point| with_compressed(point, horizon)).collect();
        let emulator = Emulator::new(&near, None)?;
        let rank = |at: &[f64]| goal.rank(&emulator.values_at(at));
        let search = Search {
            ends,
            priors,
            rank: &rank,
        };
        let middle: Vec<f64> = ends.iter().map(|(low, high)| (low + high) / 2.0).collect();
        let first = search.minimum(middle);
        let bounds = goal.bounds(&emulator.estimate(&first));
        let likelihood = |at: &[f64]| {
            let values = emulator.values_at(at);
            bounds.iter().map(|it| it.log_likelihood(&values)).sum()
        };
        let similar = Posterior::sample(ends, likelihood, seed);
        // The minimum along the coordinates can be a local one.
        let draws = similar.draws.iter();
        let lowest = draws.min_by(|a, b| {
            let ([a, b], less) = ([rank(a), rank(b)], f64::total_cmp);
            less(&a.0, &b.0).then(less(&a.1, &b.1))
        });
        let second = lowest.map(|at| search.minimum(at.clone()));
        let at = match second {
            Some(second) if rank(&second) < rank(&first) => second,
            _ => first,
        };
        let predicted = emulator.estimate(&at);
        let values = &predicted.values;
        // Random numbers that all points share shift all predictions by the same error.
        let shared = emulator.sampling_variances(common);
        let estimate = |objective: Objective| {
            let shared = objective.score_variance(values, &shared);
            let own = objective.score_variance(values, &predicted.variance);
            let (middle, half) = (objective.score(values), NORMAL * (own + shared).sqrt());
            let [value, low, high] =
                [middle, middle - half, middle + half].map(|it| objective.value(it));
            Estimate { value, low, high }
        };
        let constraints = goal.constraints.iter();
        Some(PredictedOptimum {
            value: estimate(goal.objective),
            constraints: constraints.map(|it| estimate(it.objective)).collect(),
            is_feasible: goal.rank(values).0 <= 0.0,
            at,
            similar,
        })
    }

    /// Returns the box of the next round.
    pub fn surroundings(&self, priors: &[Prior]) -> Vec<(f64, f64)> {
        let ends = self.similar.surroundings().into_iter().zip(priors);
        ends.map(|(ends, prior)| prior.surroundings(ends)).collect()
    }
}

/// Returns the horizon \[ticks\]. The search compresses longer times. Returns `None` without points.
fn horizon(points: &[Simulated], goal: Goal<'_>) -> Option<f64> {
    let means = points.iter().map(|point| {
        let times = &point.times;
        times.iter().sum::<f64>() / times.len() as f64
    });
    let lowest = means.min_by(f64::total_cmp)?;
    let objectives = goal.constraints.iter().map(|it| it.objective);
    let times = objectives.chain([goal.objective]).map(|it| match it {
        Objective::Exceeds(time) => time,
        Objective::Mean | Objective::Quantile(_) => 0.0,
    });
    Some(times.fold(LONG * lowest, f64::max))
}

/// Compresses a time above a horizon.
fn compressed(time: f64, horizon: f64) -> f64 {
    if time > horizon {
        horizon * (time / horizon).powf(COMPRESSION)
    } else {
        time
    }
}

/// Compresses times above a horizon. Times far from the optimum can be so long that no polynomial
/// fits them and the optimum.
fn with_compressed(point: &Simulated, horizon: f64) -> Simulated {
    let times = point.times.iter().map(|&time| compressed(time, horizon));
    Simulated {
        times: times.collect(),
        ..point.clone()
    }
}

/// Search for the smallest rank in a box.
struct Search<'a, F> {
    ends: &'a [(f64, f64)],
    priors: &'a [Prior],
    rank: &'a F,
}

impl<F: Fn(&[f64]) -> (f64, f64)> Search<'_, F> {
    /// Returns a point whose rank no change of one coordinate lowers. All its values are valid.
    fn minimum(&self, start: Vec<f64>) -> Vec<f64> {
        let pairs = start.iter().zip(self.priors);
        let mut at: Vec<f64> = pairs.map(|(at, prior)| prior.possible(*at)).collect();
        let mut lowest = (self.rank)(&at);
        for _ in 0..PASSES {
            let before = lowest;
            for i in 0..at.len() {
                for value in self.values(i) {
                    let old = std::mem::replace(&mut at[i], value);
                    let rank = (self.rank)(&at);
                    if rank < lowest {
                        lowest = rank;
                    } else {
                        at[i] = old;
                    }
                }
            }
            if lowest >= before {
                break;
            }
        }
        at
    }

    /// Returns valid values of a coordinate in the box.
    fn values(&self, i: usize) -> impl Iterator<Item = f64> {
        let ((low, high), prior) = (self.ends[i], &self.priors[i]);
        let share = move |step: u32| low + (high - low) * f64::from(step) / f64::from(STEPS);
        let values = (0..=STEPS).map(move |step| prior.possible(share(step)));
        values.filter(move |it| (low..=high).contains(it))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Design;
    use crate::optimize::Constraint;

    /// Returns the optimum of noisy times, in three rounds. `time` is the time at a point for an
    /// exponentially distributed random number.
    fn optimum(goal: Goal<'_>, time: impl Fn(&[f64], f64) -> f64) -> PredictedOptimum {
        let priors = [
            Prior::parse("x=0..1").unwrap(),
            Prior::parse("y=0..1").unwrap(),
        ];
        let mut ends = vec![(0.0, 1.0); 2];
        let mut points = Vec::new();
        let mut found = None;
        for round in 0..3 {
            let design = Design::latin_hypercube(&ends, 16, round);
            points.extend(design.points.into_iter().enumerate().map(|(turn, at)| {
                let share = |i: usize| ((i * 7 + turn * 3 + round as usize) % 23) as f64;
                let draw = |i| -(1.0 - (share(i) + 0.5) / 23.0).ln();
                Simulated {
                    times: (0..16).map(|i| time(&at, draw(i))).collect(),
                    incomplete: Vec::new(),
                    at,
                }
            }));
            let next = PredictedOptimum::new(&points, &ends, &priors, goal, 12.0, round);
            let next = next.unwrap();
            ends = next.surroundings(&priors);
            found = Some(next);
        }
        found.unwrap()
    }

    #[test]
    fn the_best_simulated_point_has_the_smallest_objective() {
        let priors = [Prior::parse("x=0..10").unwrap()];
        let point = |at: f64, times: [f64; 4]| Simulated {
            at: vec![at],
            times: times.to_vec(),
            incomplete: Vec::new(),
        };
        let points = [
            point(0.1, [1.0, 1.0, 1.0, 97.0]),
            point(0.5, [8.0, 9.0, 11.0, 12.0]),
        ];
        let best = |objective| BestSimulated::new(&points, &priors, objective);
        let found = best(Objective::Mean);
        assert_eq!(
            (found.numbers, found.value, found.runs),
            (vec![5.0], 10.0, 4)
        );
        assert_eq!(best(Objective::Quantile(0.5)).numbers, [1.0]);
    }

    #[test]
    fn finds_the_minimum_of_noisy_times() {
        let found = |objective| {
            let goal = Goal {
                objective,
                constraints: &[],
            };
            let law = |at: &[f64]| (6.0 + 2.0 * (at[0] - 0.3).powi(2) - 0.6 * at[1]).exp();
            optimum(goal, |at, draw| law(at) * draw)
        };
        for objective in [
            Objective::Mean,
            Objective::Quantile(0.9),
            Objective::Exceeds(400.0),
        ] {
            let found = found(objective);
            // The mean time is within 5 % of the best one.
            let excess = 2.0 * (found.at[0] - 0.3).powi(2) + 0.6 * (1.0 - found.at[1]);
            assert!(excess < 0.05, "{objective:?}: {:?}", found.at);
        }
        let Estimate { low, high, .. } = found(Objective::Mean).value;
        let truth = 5.4f64.exp();
        assert!(low < truth && truth < high, "{low} {truth} {high}");
    }

    /// Checks a law whose mean is smallest at (0.7, 1). The standard deviation increases with the
    /// first coordinate, so a constraint of a quantile excludes this point.
    #[test]
    fn constraints_move_the_optimum() {
        let mean = |at: &[f64]| (6.0 + 0.5 * (at[0] - 0.7).powi(2) - 0.6 * at[1]).exp();
        let found = |constraint: &str| {
            let goal = Goal {
                objective: Objective::Mean,
                constraints: &[Constraint::parse(constraint).unwrap()],
            };
            optimum(goal, |at, draw| mean(at) * (1.0 + at[0] * (draw - 1.0)))
        };
        let free = found("p90 <= 900");
        assert!(free.is_feasible && free.at[0] > 0.5, "{free:?}");
        // The 90 % quantile is 354 at (0.4, 1).
        let bound = found("p90 <= 354");
        assert!(bound.is_feasible && bound.constraints[0].value <= 354.0);
        assert!((bound.at[0] - 0.4).abs() < 0.12, "{:?}", bound.at);
        assert!(bound.at[1] > 0.9, "{:?}", bound.at);
        // The smallest 90 % quantile is 282 at (0, 1).
        let never = found("p90 <= 200");
        assert!(!never.is_feasible, "{:?}", never.constraints);
        assert!(never.at[0] < 0.2 && never.at[1] > 0.9, "{:?}", never.at);
    }
}
