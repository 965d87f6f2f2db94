//! Estimates the times of a program from random samples.
use rustc_hash::FxHashMap;
use stochc_ir::graph::EventId;

use super::costs::{CaptureCost, Cost};
use super::events::{Events, PhaseLimit, ProgramParts};
use super::partial_run::{PartialRun, RemainingTime};
use super::sampling::{MAX, Sampled, SampledPhase};
use super::waits::CaptureWait;
use super::{sampling, scarcity, waits};
use crate::{Interaction, LowerBoundReasons, Rates, Times, Wait};

/// Number of samples of [`times_out_rarely`].
const FEW: usize = 200;

/// Share of timeouts below which they are rare.
const RARE: f64 = 0.25;

/// Estimates the times of a program. Returns `None` if its graph has a cycle.
pub fn estimate(program: ProgramParts<'_>, rates: Option<&Rates>) -> Option<Cost> {
    let events = Events::new(program)?;
    let limits = events.limits();
    Some(estimate_within(&events, rates, &limits))
}

/// Estimates the times of a program as if its phases had no timeouts.
pub fn estimate_without_timeouts(program: ProgramParts<'_>, rates: &Rates) -> Option<Cost> {
    let events = Events::new(program)?;
    let limits = events.limits().into_iter().map(PhaseLimit::without_timeout);
    let limits: Vec<_> = limits.collect();
    Some(estimate_within(&events, Some(rates), &limits))
}

/// Returns whether clearly fewer than half of the runs that reach a phase end at its timeout, for
/// every phase. Takes few samples. Returns `false` if they do not decide it.
///
/// With `FEW` samples and a share below `RARE`, a share of one half has a probability of less
/// than 1e-5 (Hoeffding's inequality).
pub fn times_out_rarely(program: ProgramParts<'_>, rates: &Rates) -> bool {
    let Some(events) = Events::new(program) else {
        return false;
    };
    let Some((_, sampled)) = sampled(&events, rates, &events.limits(), None, FEW) else {
        return false;
    };
    let is_rare = |phase: &SampledPhase| phase.reached >= FEW / 2 && phase.timed_out < RARE;
    sampled.phases.iter().all(is_rare)
}

/// Estimates the remaining time of a run in progress. Returns `None` if the graph has a cycle, or a
/// capture has no free block left.
pub fn remaining_time(
    program: ProgramParts<'_>,
    rates: &Rates,
    run: &PartialRun,
) -> Option<RemainingTime> {
    let events = Events::new(program)?;
    let limits = events.limits();
    let (_, sampled) = sampled(&events, rates, &limits, Some(run), MAX)?;
    Some(RemainingTime::new(&sampled.draws, run.now))
}

/// Samples the event times of a program, at most `most` times. Also returns the waiting times.
/// Returns `None` if a capture has no free block left.
fn sampled(
    events: &Events<'_>,
    rates: &Rates,
    limits: &[PhaseLimit],
    partial: Option<&PartialRun>,
    most: usize,
) -> Option<(Vec<Option<CaptureWait>>, Sampled)> {
    let waits = waits::waits(events, rates);
    if (waits.iter().flatten()).any(|waits| waits.wait.rate <= 0.0) {
        return None;
    }
    let steps = events.steps();
    let scarce = scarcity::scarce_blocks(events, &steps, &waits, rates);
    let sampled = sampling::sample(events, &steps, limits, &waits, scarce, partial, most);
    Some((waits, sampled))
}

fn estimate_within(events: &Events<'_>, rates: Option<&Rates>, limits: &[PhaseLimit]) -> Cost {
    let mut cost = Cost {
        phases: events.shapes(),
        total: None,
        has_rates: rates.is_some(),
        draws: Vec::new(),
        interaction: Interaction::Apart,
        lower_bound: LowerBoundReasons::default(),
        captures: Vec::new(),
    };
    let Some(rates) = rates else {
        return cost;
    };
    let ProgramParts {
        graph,
        scene,
        jam_risks,
        ..
    } = events.parts;
    let blocks = graph.largest_structure();
    let reasons = LowerBoundReasons::new(jam_risks, rates, blocks);
    cost.lower_bound = reasons.ignoring_faults(scene);
    let Some((waits, sampled)) = sampled(events, rates, limits, None, MAX) else {
        return cost;
    };
    let complete = sampled.draws.iter().filter(|draw| draw.is_complete);
    let complete: Vec<f64> = complete.map(|draw| draw.ticks).collect();
    let never = sampled.draws.len() - complete.len();
    cost.total = Times::new(complete, never);
    cost.draws = sampled.draws;
    for (phase, sampled) in cost.phases.iter_mut().zip(sampled.phases) {
        phase.times = sampled.times;
        phase.timed_out = sampled.timed_out;
        phase.wait = sampled.wait;
    }
    let has_releases = graph.events.iter().any(|event| !event.action.is_capture());
    cost.interaction = if sampled.has_race {
        Interaction::Racing
    } else if has_releases {
        Interaction::Releases
    } else {
        Interaction::Apart
    };
    let captures = waits.iter().zip(sampled.shares).zip(sampled.waits);
    // Many captures have the same surroundings, so means are cached.
    let mut means: FxHashMap<[u64; 2], f64> = FxHashMap::default();
    let mut mean = |wait: &Wait| {
        let key = [wait.rate.to_bits(), wait.docking.to_bits()];
        *means.entry(key).or_insert_with(|| wait.mean())
    };
    cost.captures = (0..)
        .map(EventId)
        .zip(captures)
        .filter_map(|(event, ((wait, share), drawn))| {
            let CaptureWait {
                wait, head_starts, ..
            } = wait.as_ref()?;
            let drawn = drawn.filter(|_| !head_starts.is_empty());
            let wait = drawn.unwrap_or_else(|| mean(wait));
            Some(CaptureCost { event, wait, share })
        })
        .collect();
    (cost.captures).sort_by(|a, b| b.share.total_cmp(&a.share));
    cost
}
