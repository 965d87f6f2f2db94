//! The cheapest setting that a trade shows to be accurate enough.
use stochc_runtime::Settings;

use super::candidates::same;
use super::convergence::{Convergence, convergence};
use super::ranking::Verdict;
use super::result::{CandidateResult, MeasuredProgram, Trade};
use crate::text::{percent, ratio, relative, relative_size};

/// A setting that was chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// What to set; `None`: nothing is run, and `estimate` says it.
    pub settings: Option<Settings>,
    /// Why, in a sentence.
    pub why: String,
}

/// What may be chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CandidateKinds {
    /// Settings, and the estimate without runs.
    All,
    /// Settings: runs are wanted, not their times alone.
    Runs,
}

/// What helps where too little was measured.
const MORE_TIME: &str =
    "more time helps: `--budget`, or `stochc trade --resume` for a trade that is there";

/// Chooses for some programs of a trade, by their indices in it.
///
/// A candidate is accurate enough if no program's mean is further from the reference's than `accuracy`,
/// interval included, if none of its runs failed, and if it reverses no pair of these programs. The
/// reference is, if the last doubling of its substeps changed no mean by more, interval included; where
/// that is not known, nothing is. Runs that the limit of ticks has stopped tell only of times up to it: where
/// there are any, nothing is known of runs that may take longer, up to `max_ticks`.
///
/// # Errors
/// In words, with what is missing, if none is.
pub fn choose(
    trade: &Trade,
    programs: &[usize],
    max_ticks: u64,
    accuracy: f64,
    kinds: CandidateKinds,
) -> Result<Choice, String> {
    let asked = percent(accuracy);
    let Some(reference) = &trade.reference else {
        return Err(format!(
            "too few runs were made for a reference; {MORE_TIME}"
        ));
    };
    let own = &trade.candidates[reference.candidate];
    let doubling = (reference.doublings.last()).and_then(|last| last.bound(programs));
    let open = |what: String| Err(format!("{what}; {MORE_TIME}"));
    let found = convergence(&reference.doublings, programs, accuracy);
    if found != Convergence::NotConverged
        && let Some(reason) = stopped(trade, programs, max_ticks)
    {
        return Err(reason);
    }
    match found {
        Convergence::Converged => {}
        Convergence::NotConverged => {
            return open(format!(
                "the reference, `{}`, has not converged within {asked}, so that no accuracy is known",
                own.options
            ));
        }
        Convergence::Undecided => {
            return open(format!(
                "whether the reference, `{}`, has converged within {asked} is undecided: {}",
                own.options,
                match doubling {
                    _ if reference.doublings.len() < 2 =>
                        "fewer than two doublings of its substeps were measured".to_owned(),
                    Some(bound) => format!(
                        "its last doubling may have changed a mean by up to {}",
                        percent(bound)
                    ),
                    None => "there are too few runs for an interval".to_owned(),
                }
            ));
        }
    }
    let mut candidates: Vec<(f64, f64, usize)> = Vec::new();
    for (i, candidate) in trade.candidates.iter().enumerate() {
        if kinds == CandidateKinds::Runs && candidate.settings.is_none() {
            continue;
        }
        let bound = match i == reference.candidate {
            true => doubling,
            false => bound(trade, candidate, programs, max_ticks),
        };
        if let (Some(cost), Some(bound)) = (cost(candidate, programs), bound) {
            candidates.push((cost, bound, i));
        }
    }
    let enough = candidates.iter().filter(|(_, bound, _)| *bound <= accuracy);
    let Some(&(cost, bound, i)) = enough.min_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Err(format!(
            "nothing that was measured is known to be within {asked}"
        ));
    };
    let candidate = &trade.candidates[i];
    let own_cost = self::cost(own, programs);
    let why = if i == reference.candidate {
        format!(
            "`{}`, the reference itself: its last doubling of substeps changed no mean{} by more \
             than {}",
            candidate.options,
            match programs
                .iter()
                .any(|&p| trade.reference_runs_at_limit(p) > 0)
            {
                true => " of times up to the trade's limit of ticks",
                false => "",
            },
            percent(bound)
        )
    } else {
        format!(
            "`{}`, the cheapest that is within {asked}: {}, at {} of the reference's cost",
            candidate.options,
            distances(trade, candidate, programs),
            own_cost.map_or("?".to_owned(), |own| ratio(cost / own))
        )
    };
    Ok(Choice {
        settings: candidate.settings.clone(),
        why,
    })
}

/// What a trade says about settings, of these programs; `None`: it has not tried them.
pub fn note(trade: &Trade, programs: &[usize], settings: &Settings) -> Option<String> {
    let is_same = |tried: &Settings| same(tried, settings);
    let candidate = (trade.candidates.iter()).find(|candidate| {
        candidate.left_out.is_none() && candidate.settings.as_ref().is_some_and(is_same)
    })?;
    if trade.reference_candidate() == Some(candidate) {
        return Some("it is the reference of the trade".to_owned());
    }
    let pairs: Vec<String> = (candidate.reversals())
        .filter(|pair| programs.contains(&pair.first) && programs.contains(&pair.second))
        .map(|pair| {
            let name = |program: usize| &trade.programs[program].name;
            format!("{} < {}", name(pair.first), name(pair.second))
        })
        .collect();
    let distances = distances(trade, candidate, programs);
    Some(match pairs.is_empty() {
        true if distances.is_empty() => return None,
        true => format!("the trade found: {distances}"),
        false => format!(
            "the trade found it to REVERSE {}; {distances}",
            pairs.join(", ")
        ),
    })
}

fn distances(trade: &Trade, candidate: &CandidateResult, programs: &[usize]) -> String {
    let found = programs.iter().filter_map(|&p| {
        let bias = candidate.programs[p].bias?;
        let of = bias.horizon.map_or_else(String::new, |ticks| {
            format!(" in times up to {ticks:.0} ticks")
        });
        Some(match programs.len() {
            1 => format!("{} from the reference{of}", relative_size(&bias)),
            _ => format!("{} {}{of}", trade.programs[p].name, relative(&bias)),
        })
    });
    found.collect::<Vec<_>>().join(", ")
}

fn cost(candidate: &CandidateResult, programs: &[usize]) -> Option<f64> {
    programs.iter().map(|&p| candidate.programs[p].cost).sum()
}

/// Whether runs that the limit of ticks of the trade has stopped could go on for longer.
fn go_on(trade: &Trade, program: usize, max_ticks: u64) -> bool {
    max_ticks > trade.programs[program].max_ticks
}

/// Why runs up to `max_ticks` tell nothing: those of the reference were stopped before.
fn stopped(trade: &Trade, programs: &[usize], max_ticks: u64) -> Option<String> {
    let runs = |&p: &usize| trade.reference_runs_at_limit(p);
    let program =
        (programs.iter().copied()).find(|p| go_on(trade, *p, max_ticks) && runs(p) > 0)?;
    let MeasuredProgram {
        name,
        max_ticks: limit,
        ..
    } = &trade.programs[program];
    Some(format!(
        "the trade has stopped {} runs of `{name}` after {limit} ticks, in its reference or the substeps before, so that \
         no accuracy is known of runs of up to {max_ticks}; measure with `stochc trade --max-ticks {max_ticks}`, or \
         run with `--max-ticks {limit}`",
        runs(&program)
    ))
}

/// The largest bias that is not excluded; `None`: anything, or the candidate is out of the question.
fn bound(
    trade: &Trade,
    candidate: &CandidateResult,
    programs: &[usize],
    max_ticks: u64,
) -> Option<f64> {
    let wrong = candidate.ranking.iter().any(|pair| {
        pair.verdict == Verdict::Reversed
            && programs.contains(&pair.first)
            && programs.contains(&pair.second)
    });
    if wrong {
        return None;
    }
    let mut bounds = programs.iter().map(|&p| {
        let cell = &candidate.programs[p];
        let is_cut = cell.censored > 0 && go_on(trade, p, max_ticks);
        let bias = cell.bias.filter(|_| cell.failed == 0 && !is_cut);
        bias?.bound()
    });
    bounds.try_fold(0.0, |most: f64, bound| Some(most.max(bound?)))
}
