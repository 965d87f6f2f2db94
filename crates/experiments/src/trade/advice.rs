//! Recommended settings of a trade, in one or two sentences.
use super::convergence::{CLOSE, Convergence};
use super::result::{CandidateResult, Trade};
use stochc_text::{percent, ratio};

pub(super) fn advice(trade: &Trade) -> String {
    let (Some(known), Some(reference)) = (&trade.reference, trade.reference_candidate()) else {
        return "There is no reference, because too few runs of `rigid` with uniform substeps were completed. Make more \
                runs, or use a larger `--max-ticks`."
            .to_owned();
    };
    let mut sentences = Vec::new();
    let problem = match known.convergence {
        Convergence::Converged => None,
        Convergence::Undecided => Some("is not known to have converged"),
        Convergence::NotConverged => Some("has not converged"),
    };
    if let Some(problem) = problem {
        sentences.push(format!(
            "The reference, `{}`, {problem}. Biases are relative to this reference, not to the limit of small steps.",
            reference.options
        ));
    }
    let mut programs = 0..trade.programs.len();
    if programs.any(|program| trade.reference_runs_at_limit(program) > 0) {
        sentences.push(
            "The limit of ticks has stopped runs of the reference, so longer times are unknown. Use a larger \
             `--max-ticks` to measure them."
                .to_owned(),
        );
    }
    let clauses: Vec<String> = recommended(trade).into_iter().map(clause).collect();
    sentences.push(if clauses.is_empty() {
        format!(
            "No setting that is cheaper than the reference, `{}`, is known to be within {} of it.",
            reference.options,
            percent(CLOSE)
        )
    } else {
        clauses.join("; ") + "."
    });
    let reversed: Vec<String> = (trade.candidates.iter())
        .filter(|candidate| candidate.reversed)
        .map(|candidate| format!("`{}`", candidate.options))
        .collect();
    if !reversed.is_empty() {
        sentences.push(format!(
            "Do not compare programs with {}, because the order of some programs is reversed.",
            reversed.join(", ")
        ));
    }
    sentences.join(" ")
}

/// Returns the cheapest candidate whose bias has a small bound, and the candidate with the smallest
/// bound.
fn recommended(trade: &Trade) -> Vec<&CandidateResult> {
    let cheaper =
        |candidate: &&CandidateResult| candidate.cost_ratio.is_some_and(|ratio| ratio < 1.0);
    let close = |candidate: &&CandidateResult| {
        !candidate.reversed && candidate.bound.is_some_and(|bound| bound <= CLOSE)
    };
    let candidates = || trade.candidates.iter().filter(cheaper).filter(close);
    let cost = |candidate: &&CandidateResult| candidate.cost.unwrap_or(f64::INFINITY);
    let bound = |candidate: &&CandidateResult| candidate.bound.unwrap_or(f64::INFINITY);
    let cheapest = candidates().min_by(|a, b| cost(a).total_cmp(&cost(b)));
    let closest = candidates().min_by(|a, b| bound(a).total_cmp(&bound(b)));
    let mut found: Vec<&CandidateResult> = cheapest.into_iter().collect();
    found.extend(
        closest.filter(|candidate| !found.iter().any(|other| other.name == candidate.name)),
    );
    found
}

fn clause(candidate: &CandidateResult) -> String {
    let bound = candidate.bound.map_or_else(String::new, percent);
    let cost = candidate.cost_ratio.map_or_else(String::new, ratio);
    let reduced = if candidate.reduced() {
        ", but leaves out a part of the scene"
    } else {
        ""
    };
    format!(
        "`{}` is within {bound} of the reference, including the confidence interval, at {cost} of its cost{reduced}",
        candidate.options
    )
}
