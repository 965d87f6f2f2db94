//! Estimates parameters by maximum likelihood.
use nalgebra::{SMatrix, SVector};
use stochc_estimate::{Parameters, Surroundings, Wait};

use super::observation::WaitInterval;

const COUNT: usize = Parameters::COUNT;

type Vector = SVector<f64, COUNT>;
type ParameterMatrix = SMatrix<f64, COUNT, COUNT>;

/// Largest number of Newton steps.
const STEPS: usize = 200;

/// Returns the most likely parameters, and their covariance row by row.
pub(super) fn fit(intervals: &[WaitInterval]) -> ([f64; COUNT], Vec<f64>) {
    let loss = |at: &Vector| loss(intervals, at);
    let mut at = Vector::from(Parameters::TYPICAL.0);
    let (mut value, mut slope) = loss(&at);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let curvature = curvature(loss, &at);
        let damped = curvature
            + ParameterMatrix::from_diagonal(
                &curvature.diagonal().map(|it| damping * it.abs().max(1.0)),
            );
        let step = damped.cholesky().map(|factor| factor.solve(&slope));
        // Longer steps diverge far from the optimum.
        let step = step.filter(|step| step.amax() < 3.0);
        let tried = step.map(|step| (at - step, loss(&(at - step)), step.amax()));
        match tried {
            Some((next, (better, next_slope), length)) if better <= value => {
                (at, value, slope) = (next, better, next_slope);
                damping = (damping / 10.0_f64).max(1e-9);
                if length < 1e-7 {
                    break;
                }
            }
            _ if damping > 1e9 => break,
            _ => damping *= 10.0,
        }
    }
    let covariance = curvature(loss, &at)
        .try_inverse()
        .unwrap_or_else(ParameterMatrix::zeros);
    (at.into(), covariance.transpose().as_slice().to_vec())
}

/// Returns the matrix of second derivatives, by finite differences of the slopes.
fn curvature(loss: impl Fn(&Vector) -> (f64, Vector), at: &Vector) -> ParameterMatrix {
    let step = 1e-4;
    let columns: Vec<Vector> = (0..COUNT)
        .map(|i| {
            let mut aside = Vector::zeros();
            aside[i] = step;
            (loss(&(at + aside)).1 - loss(&(at - aside)).1) / (2.0 * step)
        })
        .collect();
    let matrix = ParameterMatrix::from_columns(&columns);
    (matrix + matrix.transpose()) / 2.0
}

/// Returns the negative logarithm of likelihood times prior, up to a constant, and its slope.
fn loss(intervals: &[WaitInterval], at: &Vector) -> (f64, Vector) {
    let parameters = Parameters((*at).into());
    let (mut value, mut slope) = (0.0, Vector::zeros());
    for interval in intervals {
        let wait = parameters.wait(&interval.surroundings);
        let hazard = wait.cumulative_hazard(interval.to) - wait.cumulative_hazard(interval.from);
        let (to, of_hazard) = wait.docking_slopes(interval.to);
        let (from, _) = wait.docking_slopes(interval.from);
        value += hazard;
        let (mut of_rate, mut of_docking) = (hazard, to - from);
        if interval.captured {
            value -= log_hazard(wait, interval.to);
            of_rate -= 1.0;
            of_docking -= of_hazard;
        }
        add(&mut slope, &interval.surroundings, of_rate, of_docking);
    }
    for i in 0..COUNT {
        let off = (at[i] - Parameters::TYPICAL.0[i]) / Parameters::SPREAD[i];
        value += 0.5 * off * off;
        slope[i] += off / Parameters::SPREAD[i];
    }
    (value, slope)
}

/// Returns the logarithm of the hazard of a capture after `ticks`. A capture takes at least one
/// tick.
fn log_hazard(wait: Wait, ticks: f64) -> f64 {
    wait.hazard(ticks.max(1.0)).max(f64::MIN_POSITIVE).ln()
}

fn add(slope: &mut Vector, surroundings: &Surroundings, of_rate: f64, of_docking: f64) {
    let (rate, docking) = Parameters::features(surroundings);
    let of_rates = rate.iter().map(|feature| of_rate * feature);
    let of_dockings = docking.iter().map(|feature| of_docking * feature);
    for (slope, more) in slope.iter_mut().zip(of_rates.chain(of_dockings)) {
        *slope += more;
    }
}
