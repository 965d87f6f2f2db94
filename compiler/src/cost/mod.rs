//! What can be said of a program's effort without running it.
//!
//! How deep and how wide its phases are follows from its graph alone. Times need the rates of a scene: each capture waits by
//! their law in the structure as it stands when its turn comes, and the waits are summed up along the graph, with the time that messages
//! take. That is less than a run by rates knows: cells beside an open face fill while it waits.
mod convolution;
mod drawn_times;
mod message_times;
mod occupancy;
mod phase_events;
mod sampling;
mod scarcity;
mod schedule;
mod steps;
mod timed_phase;
mod waits;

use rustc_hash::FxHashMap;
use stochc_ir::Draw;
use stochc_rates::{Interaction, LowerBoundReasons, Rates, Times, Wait};

use crate::Program;
use crate::plan::{EventId, EventKind};
use convolution::bits;
use waits::CaptureWait;

/// What is known of a program without running it.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// The phases, in order.
    pub phases: Vec<PhaseCost>,
    /// How long all of it takes, which is for ever where a phase comes to its timeout; `None`: there are no rates, there is a capture for
    /// which no block is left, or a phase comes to its timeout nine times in ten.
    pub total: Option<Times>,
    /// Whether there were rates.
    pub has_rates: bool,
    /// Whether the times were worked out and not drawn, so that there is no chance in them: the halves of their intervals are 0.
    pub is_exact: bool,
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

/// Looks at a program; `None` if it has no order.
pub fn estimate(program: &Program, rates: Option<&Rates>) -> Option<Cost> {
    estimate_within(program, rates, &steps::timeouts(program))
}

/// Looks at a program as if its phases had no timeouts.
pub(crate) fn estimate_without_timeouts(program: &Program, rates: Option<&Rates>) -> Option<Cost> {
    estimate_within(
        program,
        rates,
        &vec![f64::INFINITY; program.plan.phases.len()],
    )
}

fn estimate_within(program: &Program, rates: Option<&Rates>, timeouts: &[f64]) -> Option<Cost> {
    let order = program.order.as_ref()?;
    let plan = &program.plan;
    let levels = schedule::levels(program, order);
    let mut cost = Cost {
        phases: (plan.phases.iter())
            .map(|phase| schedule::shape(program, phase, &levels))
            .collect(),
        total: None,
        has_rates: rates.is_some(),
        is_exact: false,
        draws: Vec::new(),
        interaction: Interaction::Apart,
        lower_bound: LowerBoundReasons::default(),
        captures: Vec::new(),
    };
    let Some(rates) = rates else {
        return Some(cost);
    };
    let largest = program.layout.sizes.iter().copied().max().unwrap_or(0);
    cost.lower_bound = LowerBoundReasons::new(&program.jam_risks, rates, largest);
    let waits = waits::waits(program, &levels, rates);
    if (waits.iter().flatten()).any(|waits| waits.wait.rate <= 0.0) {
        return Some(cost);
    }
    let steps = steps::steps(program, order);
    let scarce = scarcity::scarce_blocks(program, &steps, &waits, rates);
    let exact = match scarce {
        None => convolution::exact_times(&steps, timeouts, &waits),
        Some(_) => None,
    };
    let sampled = sampling::sample(program, &steps, timeouts, &waits, scarce);
    let complete = sampled.draws.iter().filter(|draw| draw.is_complete);
    let complete: Vec<f64> = complete.map(|draw| draw.ticks).collect();
    let never = sampled.draws.len() - complete.len();
    cost.total = Times::new(complete, never);
    cost.draws = sampled.draws;
    for (phase, sampled) in cost.phases.iter_mut().zip(sampled.phases) {
        phase.times = sampled.times;
        phase.timed_out = sampled.timed_out;
    }
    if let Some((phases, total)) = exact {
        cost.total = Some(total);
        for (phase, times) in cost.phases.iter_mut().zip(phases) {
            phase.times = Some(times);
        }
        cost.is_exact = true;
    }
    cost.interaction = interaction(program, sampled.has_race);
    let captures = waits.iter().zip(sampled.shares).zip(sampled.waits);
    // Many captures have the same surroundings.
    let mut means: FxHashMap<[u64; 2], f64> = FxHashMap::default();
    let mut mean = |wait: &Wait| {
        let mean = means.entry(bits(*wait));
        *mean.or_insert_with(|| wait.mean())
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
    Some(cost)
}

fn interaction(program: &Program, has_race: bool) -> Interaction {
    let is_release = |event: &crate::plan::PlanEvent| event.kind == EventKind::Release;
    match has_race {
        true => Interaction::Racing,
        false if program.plan.events.iter().any(is_release) => Interaction::Releases,
        false => Interaction::Apart,
    }
}
