//! What can be said of a program's effort without running it.
//!
//! How deep and how wide its phases are follows from its graph alone. Times need the rates of a scene: each capture waits by
//! their law in the structure as it stands when its turn comes, and the waits are summed up along the graph. That is less than a
//! run by rates knows: cells beside an open face fill while it waits, and messages take their time.
mod occupancy;
mod phase_events;
mod sampling;
mod schedule;
mod waits;

pub use sampling::Times;

use stochc_rates::{Rates, Wait};

use crate::Program;
use crate::plan::EventId;

/// What is known of a program without running it.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// The phases, in order.
    pub phases: Vec<PhaseCost>,
    /// How long all of it takes; `None`: there are no rates, or a capture for which no block is left.
    pub total: Option<Times>,
    /// The captures, the one first that decides most of the time; those of equal shares in source order. None without times.
    pub captures: Vec<CaptureCost>,
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
}

/// What a capture costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaptureCost {
    /// Which.
    pub event: EventId,
    /// How long its face waits, where no block was let go near it.
    pub wait: Wait,
    /// The part of all time in which nothing but it is waited for.
    pub share: f64,
}

/// Looks at a program; `None` if it has no order.
pub fn estimate(program: &Program, rates: Option<&Rates>) -> Option<Cost> {
    let order = program.order.as_ref()?;
    let plan = &program.plan;
    let levels = schedule::levels(program, order);
    let mut cost = Cost {
        phases: (plan.phases.iter())
            .map(|phase| schedule::shape(program, phase, &levels))
            .collect(),
        total: None,
        captures: Vec::new(),
    };
    let Some(rates) = rates else {
        return Some(cost);
    };
    let waits = waits::waits(program, &levels, rates);
    if (waits.iter().flatten()).any(|waits| waits.wait.rate <= 0.0) {
        return Some(cost);
    }
    let sampled = sampling::sample(program, order, &waits);
    cost.total = Some(sampled.total);
    for (phase, times) in cost.phases.iter_mut().zip(sampled.phases) {
        phase.times = Some(times);
    }
    let captures = waits.iter().zip(sampled.shares).enumerate();
    cost.captures = captures
        .filter_map(|(i, (wait, share))| {
            let event = EventId(i as u32);
            let wait = wait.as_ref()?.wait;
            Some(CaptureCost { event, wait, share })
        })
        .collect();
    (cost.captures).sort_by(|a, b| b.share.total_cmp(&a.share));
    Some(cost)
}
