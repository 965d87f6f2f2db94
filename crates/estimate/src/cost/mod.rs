//! What can be said of a program's effort without running it.
//!
//! How deep and how wide its phases are follows from its graph alone. Times need the rates of a scene: each capture waits by
//! their law in the structure as it stands when its turn comes, and the waits are summed up along the graph, with the time that messages
//! take. That is less than a run by rates knows: cells beside an open face fill while it waits.
mod drawn_times;
mod events;
mod message_times;
mod occupancy;
mod sampling;
mod scarcity;
mod timed_phase;
mod waits;

use rustc_hash::FxHashMap;
use stochc_ir::Draw;
use stochc_ir::graph::EventId;

use crate::{Interaction, LowerBoundReasons, Rates, Times, Wait};
use events::Events;
pub use events::ProgramParts;
use waits::CaptureWait;

/// What is known of a program without running it.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// The phases, in order.
    pub phases: Vec<PhaseCost>,
    /// How long all of it takes, which is for ever where a phase comes to its timeout. `None` means
    /// there are no rates, there is a capture for which no block is left, or a phase comes to its
    /// timeout nine times in ten.
    pub total: Option<Times>,
    /// Whether there were rates.
    pub has_rates: bool,
    /// Times of the whole that were drawn, in the order of drawing. None without times.
    pub draws: Vec<Draw>,
    /// What times leave out.
    pub interaction: Interaction,
    /// Reasons why the times are lower bounds. Empty if they are estimates.
    pub lower_bound: LowerBoundReasons,
    /// The captures, the one first that decides most of the time; those of equal shares in source order. None without times.
    pub captures: Vec<CaptureCost>,
}

impl Cost {
    /// Times that were drawn in which a phase came to its timeout.
    pub fn stopped(&self) -> usize {
        self.draws.iter().filter(|draw| !draw.is_complete).count()
    }
}

/// How a phase is ordered, and how long it takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseCost {
    /// Captures of its longest serial chain.
    pub depth: u32,
    /// The most captures that are waited for side by side, if all take equally long.
    pub width: u32,
    /// How long it takes; `None` as for the whole.
    pub times: Option<Times>,
    /// The share of its draws that end at its timeout.
    pub timed_out: f64,
}

/// What a capture costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaptureCost {
    /// Which.
    pub event: EventId,
    /// How long its face waits on average, blocks included that are let go near it \[tick\].
    pub wait: f64,
    /// The part of all time in which nothing but it is waited for.
    pub share: f64,
}

/// Estimates the times of a program. Returns `None` if its graph has a cycle.
pub fn estimate(program: ProgramParts<'_>, rates: Option<&Rates>) -> Option<Cost> {
    let events = Events::new(program)?;
    let timeouts = events.timeouts();
    Some(estimate_within(&events, rates, &timeouts))
}

/// Estimates the times of a program as if its phases had no timeouts.
pub fn estimate_without_timeouts(program: ProgramParts<'_>, rates: &Rates) -> Option<Cost> {
    let events = Events::new(program)?;
    let timeouts = vec![f64::INFINITY; program.tables.phases.len()];
    Some(estimate_within(&events, Some(rates), &timeouts))
}

fn estimate_within(events: &Events<'_>, rates: Option<&Rates>, timeouts: &[f64]) -> Cost {
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
        graph, jam_risks, ..
    } = events.parts;
    cost.lower_bound = LowerBoundReasons::new(jam_risks, rates, graph.largest_structure());
    let waits = waits::waits(events, rates);
    if (waits.iter().flatten()).any(|waits| waits.wait.rate <= 0.0) {
        return cost;
    }
    let steps = events.steps();
    let scarce = scarcity::scarce_blocks(events, &steps, &waits, rates);
    let sampled = sampling::sample(events, &steps, timeouts, &waits, scarce);
    let complete = sampled.draws.iter().filter(|draw| draw.is_complete);
    let complete: Vec<f64> = complete.map(|draw| draw.ticks).collect();
    let never = sampled.draws.len() - complete.len();
    cost.total = Times::new(complete, never);
    cost.draws = sampled.draws;
    for (phase, sampled) in cost.phases.iter_mut().zip(sampled.phases) {
        phase.times = sampled.times;
        phase.timed_out = sampled.timed_out;
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
    // Many captures have the same surroundings.
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
