//! Decisions about claims without runs, from the distribution of the rate model.
//!
//! If the captures of a program happen one after the other, its waiting times are independent.
//! Every claimed time is a sum of waiting times. The distribution of the sum is a convolution.
use std::sync::atomic::{AtomicBool, Ordering};

use stochc_estimate::{Rates, SerialCapture, serial_captures};
use stochc_ir::claim::{Claim, ClaimedEvent, Relation};
use stochc_ir::graph::EventAction;
use stochc_results::EnsembleProgram;

use crate::claims::{ClaimMethod, ClaimedQuantity, ModelError, TestedClaim, Verdict};
use crate::statistics::SumDistribution;

/// Largest time with a computed probability \[ticks\].
const MAX_TICKS: f64 = 1e6;

/// Bound of the relative numerical error of a mean.
const ERROR: f64 = 1e-9;

/// Probability below which a waiting time is cut off.
const NEGLIGIBLE: f64 = 1e-15;

/// Decides the claims of the first program in the rate model. `rates` are those of each program,
/// and `error` is the error of their times. `programs` contains all programs that the claims name.
///
/// The result of a claim is `None` if it needs runs, or if `stop` is set during the computation.
pub fn decide_claims(
    claims: &[Claim],
    programs: &[EnsembleProgram],
    rates: &[&Rates],
    error: ModelError,
    stop: &AtomicBool,
) -> Vec<Option<TestedClaim>> {
    let captures =
        |program: &EnsembleProgram, rates: &Rates| serial_captures(program.parts(), rates);
    let Some(own) =
        (programs.first().zip(rates.first())).and_then(|(program, rates)| captures(program, rates))
    else {
        return vec![None; claims.len()];
    };
    let decided = claims.iter().map(|claim| match claim {
        Claim::Probability {
            event,
            within,
            relation,
            bound,
        } => {
            let captures = counted(&programs[0], &own, *event)?;
            let limits = [error.longest, error.shortest, 1.0]
                .map(|factor| within.map_or(f64::INFINITY, |within| within / factor));
            let ([low, high, estimate], rounding) = probabilities(captures, limits, stop)?;
            let limits = ((low - rounding).max(0.0), (high + rounding).min(1.0));
            let is_known = within.is_some() || error.longest.is_finite();
            let limits = if is_known { limits } else { (0.0, limits.1) };
            let verdict = verdict(limits, *bound, *relation);
            Some(computed(
                verdict,
                ClaimedQuantity::Probability,
                estimate,
                limits,
            ))
        }
        Claim::Mean { relation, bound } => {
            let mean = mean(&own)?;
            let limits = (mean * error.shortest, mean * error.longest);
            let limits = (limits.0 * (1.0 - ERROR), limits.1 * (1.0 + ERROR));
            let verdict = verdict(limits, *bound, *relation);
            Some(computed(verdict, ClaimedQuantity::Mean, mean, limits))
        }
        Claim::Faster { than, by } => {
            let mut all = programs.iter().zip(rates);
            let (program, rates) = all.find(|(program, _)| program.assembly() == than)?;
            let ticks = program.scene.tick / programs[0].scene.tick;
            let ratio = mean(&own)? / (mean(&captures(program, rates)?)? * ticks);
            let limit = |factor: f64| 1.0 - ratio * factor;
            let spread = error.longest / error.shortest;
            let limits = (limit(spread) - ERROR, limit(1.0 / spread) + ERROR);
            let verdict = verdict(limits, *by, Relation::AtLeast);
            Some(computed(
                verdict,
                ClaimedQuantity::Difference,
                limit(1.0),
                limits,
            ))
        }
    });
    decided.collect()
}

fn computed(
    verdict: Verdict,
    quantity: ClaimedQuantity,
    estimate: f64,
    limits: (f64, f64),
) -> TestedClaim {
    TestedClaim {
        verdict,
        quantity,
        estimate: Some(estimate),
        limits,
        runs: 0,
        cpu: None,
        method: ClaimMethod::Convolution,
    }
}

fn verdict((low, high): (f64, f64), bound: f64, relation: Relation) -> Verdict {
    match relation {
        Relation::AtLeast if low >= bound => Verdict::Holds,
        Relation::AtMost if high <= bound => Verdict::Holds,
        Relation::AtLeast if high < bound => Verdict::Fails,
        Relation::AtMost if low > bound => Verdict::Fails,
        _ => Verdict::Undecided,
    }
}

/// Returns the captures whose waiting times sum up to the time of an event. Returns `None` if the
/// event is a capture before the first phase.
fn counted<'a>(
    program: &EnsembleProgram,
    captures: &'a [SerialCapture],
    event: ClaimedEvent,
) -> Option<&'a [SerialCapture]> {
    match event {
        ClaimedEvent::Completion => Some(captures),
        ClaimedEvent::Phase(phase) => {
            let begin = captures.partition_point(|it| it.phase < phase);
            let end = captures.partition_point(|it| it.phase <= phase);
            Some(&captures[begin..end])
        }
        ClaimedEvent::Capture { block, by } => {
            let is_claimed = |it: &SerialCapture| {
                let action = program.compiled.graph.event(it.event).action;
                matches!(action, EventAction::Capture { parent, child, .. } if parent == by && child == block)
            };
            let last = captures.iter().position(is_claimed)?;
            Some(&captures[..=last])
        }
    }
}

/// Returns the probability that the sum of waiting times is at most each of the limits \[ticks\].
/// Also returns the largest numerical error of a probability. Returns `None` if a limit is too
/// large, or if `stop` is set.
fn probabilities<const N: usize>(
    captures: &[SerialCapture],
    limits: [f64; N],
    stop: &AtomicBool,
) -> Option<([f64; N], f64)> {
    let finite = limits.iter().copied().filter(|limit| limit.is_finite());
    let largest = finite.fold(0.0, f64::max);
    if largest > MAX_TICKS {
        return None;
    }
    let terms = largest as usize + 1;
    let mut sum = SumDistribution::new(terms);
    for capture in captures {
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        sum.add(probabilities_of_ticks(*capture, terms));
    }
    let error = sum.error();
    let sum = sum.finish();
    let probabilities = limits.map(|limit| {
        if limit.is_infinite() {
            1.0
        } else {
            sum.iter().take(limit as usize + 1).sum()
        }
    });
    Some((probabilities, error))
}

/// Returns the probability of each waiting time up to `terms - 1` ticks.
fn probabilities_of_ticks(capture: SerialCapture, terms: usize) -> Vec<f64> {
    let mut before = 1.0;
    let open = capture.survival().take(terms);
    let open = open.take_while(|&open| open > NEGLIGIBLE);
    open.map(|open| std::mem::replace(&mut before, open) - open)
        .collect()
}

/// Returns the mean of the sum of all waiting times \[ticks\]. Returns `None` if a waiting time is
/// too long.
fn mean(captures: &[SerialCapture]) -> Option<f64> {
    let means = captures.iter().map(|capture| {
        let mut mean = 0.0;
        for (ticks, open) in capture.survival().enumerate() {
            if open <= NEGLIGIBLE {
                return Some(mean);
            }
            if ticks as f64 > MAX_TICKS {
                return None;
            }
            mean += open;
        }
        None
    });
    means.sum()
}
