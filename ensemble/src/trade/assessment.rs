//! Every setting against the reference: from runs to a trade.

use stochc_runtime::Settings;

use super::advice::advice;
use super::candidates::{flags, refines, short};
use super::convergence::{CLOSE, Convergence, Doubling, at_limit, convergence};
use super::estimate::{self, EstimatedSamples};
use super::plan::CandidateOutcome;
use super::ranking::{Ranked, Verdict, rank};
use super::result::{CandidateResult, FORMAT, MeasuredProgram, ProgramResult, Reference, Trade};
use super::sample::{End, Sample};
use crate::Time;
use crate::statistics::{Observation, Relative, Runs, distance, relative};

/// How it was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// The seed of every draw.
    pub seed: u64,
    /// Runs at the same time.
    pub threads: usize,
    /// Runs of each program at each candidate, where they were asked for.
    pub runs: Option<u64>,
    /// Time for all of it \[s\], where that was asked for.
    pub budget: Option<f64>,
    /// Whether it came to its end.
    pub complete: bool,
}

impl Trade {
    /// Draws it up; `limits` are the ticks after which runs of each program were given up.
    pub fn of(
        programs: &[crate::EnsembleProgram],
        outcomes: &[CandidateOutcome],
        estimated: &EstimatedSamples,
        limits: &[u64],
        means: Conditions,
    ) -> Trade {
        let rows: Vec<Row> = (outcomes.iter().map(Row::of_outcome))
            .chain([Row::of_estimate(estimated)])
            .collect();
        let times: Vec<Vec<Vec<Observation>>> = (rows.iter())
            .map(|row| row.samples.iter().map(Sample::times).collect())
            .collect();
        let runs: Vec<Vec<Runs>> = (rows.iter())
            .map(|row| {
                let samples = row.samples.iter();
                samples.map(|sample| sample.runs(means.seed)).collect()
            })
            .collect();
        let reference = reference(outcomes, &times);
        let against = reference.as_ref().map(|r| r.candidate);
        let mut candidates: Vec<CandidateResult> = (rows.iter().zip(&times).enumerate())
            .map(|(i, (row, own))| {
                let ranking = match against {
                    Some(r) if !row.samples.iter().all(Sample::is_empty) => {
                        rank(&runs[r], &runs[i])
                    }
                    _ => Vec::new(),
                };
                let reference = against.filter(|&r| r != i).map(|r| &times[r][..]);
                candidate(row, own, reference, ranking)
            })
            .collect();
        let whole = against.and_then(|r| candidates[r].cost);
        for candidate in &mut candidates {
            candidate.cost_ratio = candidate.cost.zip(whole).map(|(cost, whole)| cost / whole);
        }
        draw_front(&mut candidates, against);
        let described = programs
            .iter()
            .zip(limits)
            .map(|(program, &max_ticks)| MeasuredProgram {
                name: program.name.clone(),
                hash: program.hash(),
                max_ticks,
                scene: program.scene.clone(),
            });
        let mut trade = Trade {
            format: FORMAT,
            stochc: env!("CARGO_PKG_VERSION").to_owned(),
            seed: means.seed,
            threads: means.threads,
            runs: means.runs,
            budget: means.budget,
            complete: means.complete,
            programs: described.collect(),
            reference,
            candidates,
            advice: String::new(),
        };
        trade.advice = advice(&trade);
        trade
    }
}

/// The finest candidate that has at least two completed runs of each program.
fn reference(outcomes: &[CandidateOutcome], times: &[Vec<Vec<Observation>>]) -> Option<Reference> {
    let known = |i: &usize| {
        let enough =
            |times: &Vec<Observation>| times.iter().filter(|o| o.is_completed()).count() > 1;
        refines(&outcomes[*i].settings) && times[*i].iter().all(enough)
    };
    let substeps = |i: usize| outcomes[i].settings.substeps;
    let mut candidates: Vec<usize> = (0..outcomes.len()).filter(known).collect();
    candidates.sort_by_key(|&i| substeps(i));
    let candidate = *candidates.last()?;
    let doubling = |pair: &[usize]| {
        let [from, to] = [pair[0], pair[1]].map(|i| (substeps(i), &times[i][..]));
        Doubling::of(from, to)
    };
    let doublings: Vec<Doubling> = candidates.windows(2).map(doubling).collect();
    let programs: Vec<usize> = (0..times[candidate].len()).collect();
    let is_cut = doublings.last().is_some_and(Doubling::is_cut);
    Some(Reference {
        candidate,
        convergence: match convergence(&doublings, &programs, CLOSE) {
            // Of longer times nothing is known.
            Convergence::Converged if is_cut => Convergence::Undecided,
            found => found,
        },
        bound: doublings.last().and_then(|last| last.bound(&programs)),
        doublings,
    })
}

/// A setting that was tried, or the estimate.
struct Row<'a> {
    name: String,
    options: String,
    settings: Option<&'a Settings>,
    left_out: Option<&'a str>,
    samples: &'a [Sample],
}

impl Row<'_> {
    fn of_outcome(outcome: &CandidateOutcome) -> Row<'_> {
        Row {
            name: short(&outcome.settings),
            options: flags(&outcome.settings),
            settings: Some(&outcome.settings),
            left_out: outcome.left_out.as_deref(),
            samples: &outcome.samples,
        }
    }

    fn of_estimate(estimated: &EstimatedSamples) -> Row<'_> {
        Row {
            name: estimate::NAME.to_owned(),
            options: estimate::COMMAND.to_owned(),
            settings: None,
            left_out: estimated.left_out.as_deref(),
            samples: &estimated.samples,
        }
    }
}

fn candidate(
    row: &Row<'_>,
    times: &[Vec<Observation>],
    reference: Option<&[Vec<Observation>]>,
    ranking: Vec<Ranked>,
) -> CandidateResult {
    let cells: Vec<ProgramResult> = (row.samples.iter().zip(times).enumerate())
        .map(|(i, (sample, own))| ProgramResult {
            // What is drawn has no ticks that cost anything.
            cost_of_tick: row.settings.and_then(|_| sample.cost_of_tick()),
            ..cell(sample, own, reference.map(|times| &times[i][..]))
        })
        .collect();
    let costs: Option<Vec<f64>> = cells.iter().map(|cell| cell.cost).collect();
    let biases: Option<Vec<Relative>> = cells.iter().map(|cell| cell.bias).collect();
    let measured = row.samples.iter().any(|sample| !sample.is_empty());
    let mut compared = times.iter().chain(reference.into_iter().flatten());
    let is_cut = compared.any(|times| at_limit(times) > 0);
    CandidateResult {
        name: row.name.clone(),
        options: row.options.clone(),
        settings: row.settings.cloned(),
        left_out: match (row.left_out, measured) {
            (Some(reason), _) => Some(reason.to_owned()),
            (None, true) => None,
            (None, false) => Some("there was no time for it".to_owned()),
        },
        cost: costs.map(|costs| costs.iter().sum::<f64>() / costs.len() as f64),
        cost_ratio: None,
        bound: biases.as_ref().filter(|_| !is_cut).and_then(|biases| {
            let mut bounds = biases.iter().map(Relative::bound);
            bounds.try_fold(0.0, |most: f64, bound| Some(most.max(bound?)))
        }),
        worst: biases.and_then(|biases| {
            let size = |bias: &Relative| bias.value.abs();
            biases
                .into_iter()
                .max_by(|a, b| size(a).total_cmp(&size(b)))
        }),
        front: false,
        reversed: ranking.iter().any(|pair| pair.verdict == Verdict::Reversed),
        ranking,
        programs: cells,
    }
}

fn cell(
    sample: &Sample,
    times: &[Observation],
    reference: Option<&[Observation]>,
) -> ProgramResult {
    let time = Time::of(times);
    ProgramResult {
        runs: sample.len(),
        completed: sample.count(End::Completed),
        timed_out: sample.count(End::TimedOut),
        censored: sample.count(End::Censored),
        failed: sample.count(End::Failed),
        mean: time.as_ref().map(|time| time.mean),
        half_width: time.as_ref().and_then(|time| time.half_width),
        horizon: time.as_ref().and_then(|time| time.horizon),
        bias: reference.and_then(|reference| relative(times, reference)),
        distance: reference.and_then(|reference| distance(times, reference)),
        cost: sample.cost(),
        cost_of_tick: None,
    }
}

/// Marks the candidates that no other one beats, the reference among them with no bias at all.
///
/// What counts of a bias is its bound, since of an interval's middle nothing follows.
fn draw_front(candidates: &mut [CandidateResult], reference: Option<usize>) {
    let bias = |i: usize, candidate: &CandidateResult| match reference == Some(i) {
        true => Some(0.0),
        false => candidate.bound,
    };
    let place = |(i, candidate): (usize, &CandidateResult)| {
        Some((candidate.cost?, bias(i, candidate)?)).filter(|_| !candidate.reversed)
    };
    let places: Vec<Option<(f64, f64)>> = candidates.iter().enumerate().map(place).collect();
    for (i, candidate) in candidates.iter_mut().enumerate() {
        let Some((cost, bias)) = places[i] else {
            continue;
        };
        let beaten = |other: &(f64, f64)| {
            other.0 <= cost && other.1 <= bias && (other.0 < cost || other.1 < bias)
        };
        candidate.front = !places.iter().flatten().any(beaten);
    }
}
