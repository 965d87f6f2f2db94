//! Estimates the completion time of a program without simulating it.
//!
//! Depth and width of the phases follow from the graph alone. Times need the rates of the scene.
//! Each capture gets a waiting time for the structure at its turn. Waiting times and message delays
//! are summed along the graph. Runs of the rate model are more detailed: there, cells next to an
//! open face fill while it waits.
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

/// Estimated cost of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// The phases, in order.
    pub phases: Vec<PhaseCost>,
    /// Completion time of the program. Infinite in samples with a timeout. `None` without rates,
    /// with too few free blocks, or if at least nine tenths of the samples have a timeout.
    pub total: Option<Times>,
    /// Whether rates were given.
    pub has_rates: bool,
    /// Sampled completion times, in random order. Empty without times.
    pub draws: Vec<Draw>,
    /// Interactions that the times neglect.
    pub interaction: Interaction,
    /// Reasons why the times are lower bounds. Empty if they are estimates.
    pub lower_bound: LowerBoundReasons,
    /// The captures by decreasing share of the total time. Equal shares are in source order. Empty
    /// without times.
    pub captures: Vec<CaptureCost>,
}

impl Cost {
    /// Returns the number of samples with a timeout.
    pub fn stopped(&self) -> usize {
        self.draws.iter().filter(|draw| !draw.is_complete).count()
    }
}

/// Structure and duration of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseCost {
    /// Number of captures on its longest serial chain.
    pub depth: u32,
    /// Largest number of simultaneously open faces if all captures take equally long.
    pub width: u32,
    /// Duration. `None` under the same conditions as for the program.
    pub times: Option<Times>,
    /// Share of its samples that end at its timeout.
    pub timed_out: f64,
}

/// Cost of a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaptureCost {
    /// The capture.
    pub event: EventId,
    /// Mean waiting time of its face \[ticks\]. Includes captures of blocks that are released
    /// nearby.
    pub wait: f64,
    /// Share of the total time with this capture on the critical path.
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
