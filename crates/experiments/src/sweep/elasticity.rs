//! Elasticities of the mean completion time in a sweep.
use serde::Serialize;

use super::outcome::programs;
use super::{SweepPoint, SweptNumber};
use crate::resampling::Replicates;
use crate::{ElasticityRow, Estimate, elasticity};

/// Smallest number of runs of a point for an interval.
const MIN_RUNS: u64 = 10;

/// Elasticity of the mean completion time of a program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweptElasticity {
    /// Name of the program without the values of a point.
    pub program: String,
    /// Name of the parameter.
    pub parameter: String,
    /// Elasticity. `None` if too few points have enough complete runs.
    pub elasticity: Option<Estimate>,
    /// Number of points that determine the elasticity.
    pub points: usize,
}

impl SweepPoint {
    /// Returns whether the mean of the point is known, with an interval.
    fn has_mean(&self) -> bool {
        self.completed as u64 == self.runs && self.runs >= MIN_RUNS
    }
}

/// Returns the elasticity of each program for each axis whose values are positive and differ. `sums`
/// contains the sum of the completion times of each point, with the same seed. Ignores points with
/// incomplete runs, whose mean is unknown, and points with few runs.
pub(super) fn elasticities(
    axes: &[SweptNumber],
    points: &[SweepPoint],
    sums: &[Replicates],
) -> Vec<SweptElasticity> {
    let sums: Vec<Vec<f64>> = sums.iter().map(Replicates::values).collect();
    let mut found = Vec::new();
    for program in programs(points) {
        let own = || {
            let pairs = points.iter().zip(&sums);
            pairs.filter(|(point, _)| point.program == program)
        };
        for (axis, parameter) in axes.iter().enumerate() {
            let values = || own().map(|(point, _)| point.values[axis].si);
            let first = values().next();
            if values().any(|it| it <= 0.0) || values().all(|it| Some(it) == first) {
                continue;
            }
            let mut rows: Vec<(_, ElasticityRow<'_>)> = Vec::new();
            for (point, sums) in own().filter(|(point, _)| point.has_mean()) {
                let mut others = point.values.clone();
                let value = others.remove(axis).si;
                let others = (others, &point.chosen);
                // All points have the same number of runs, so sums have the slope of means.
                let at = (value.ln(), &**sums);
                match rows.iter_mut().find(|(row, _)| *row == others) {
                    Some((_, row)) => row.push(at),
                    None => rows.push((others, vec![at])),
                }
            }
            let rows: Vec<_> = rows.into_iter().map(|(_, row)| row).collect();
            found.push(SweptElasticity {
                program: program.to_owned(),
                parameter: parameter.name.clone(),
                elasticity: elasticity(&rows),
                points: rows.iter().map(Vec::len).filter(|it| *it > 1).sum(),
            });
        }
    }
    found
}
