//! What a program will cost, from its graph and geometry alone.
//!
//! Nothing here knows of speeds, fields or densities. The assumption is that a face waits for its block the
//! longer, the less of the space around its cell is open: the mean wait is the inverse of the exposure
//! (`exposure.rs`), in waits of a cell that is open to all sides. With that, the dependency graph says
//! which waits add up and which run side by side (`schedule.rs`). Good for ranking the captures of one
//! program; for times there is the simulator.
mod exposure;
mod schedule;

use crate::Program;
use crate::plan::EventId;

/// The expected cost of a program.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// The phases, in order.
    pub phases: Vec<PhaseCost>,
    /// The captures, the one that takes the largest share of the time first.
    pub captures: Vec<CaptureCost>,
    /// Mean time to completion, in waits of a cell that is open to all sides.
    pub time: f64,
}

/// The expected cost of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseCost {
    /// Captures of its longest serial chain.
    pub depth: u32,
    /// The most captures that are waited for side by side, if all take equally long.
    pub width: u32,
    /// Its share of the time to completion, from 0 to 1.
    pub share: f64,
}

/// The expected cost of a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaptureCost {
    /// Which.
    pub event: EventId,
    /// The part of all directions from the centre of its cell that are open, from 0 to 1.
    pub exposure: f64,
    /// Mean wait, in waits of a cell that is open to all sides.
    pub wait: f64,
    /// Its share of the time to completion, from 0 to 1: what of its wait nothing else hides.
    pub share: f64,
}

/// Estimates a program; `None` if it has no order.
pub fn estimate(program: &Program) -> Option<Cost> {
    let order = program.order.as_ref()?;
    let levels = schedule::levels(program, order);
    let exposures = exposure::exposures(program, &levels);
    let shares = schedule::shares(program, order, &exposures);
    let time = shares.time;
    let share = |of: f64| if time > 0.0 { of / time } else { 0.0 };
    let phases = (program.plan.phases.iter().zip(&shares.phases))
        .map(|(phase, &spent)| {
            let mut counts: Vec<u32> = Vec::new();
            for id in program.plan.events_of(phase) {
                if let (Some(_), level) = (exposures[id.0 as usize], levels[id.0 as usize]) {
                    counts.resize(counts.len().max(level as usize + 1), 0);
                    counts[level as usize] += 1;
                }
            }
            PhaseCost {
                depth: counts.len().saturating_sub(1) as u32,
                width: counts.iter().copied().max().unwrap_or(0),
                share: share(spent),
            }
        })
        .collect();
    let mut captures: Vec<CaptureCost> = (exposures.iter().enumerate())
        .filter_map(|(i, exposure)| {
            let exposure = (*exposure)?;
            Some(CaptureCost {
                event: EventId(i as u32),
                exposure,
                wait: schedule::wait(exposure),
                share: share(shares.captures[i]),
            })
        })
        .collect();
    // What rounding alone tells apart keeps the order of the source.
    let rounded = |share: f64| (share * 1e9).round() as u64;
    captures.sort_by_key(|capture| std::cmp::Reverse(rounded(capture.share)));
    Some(Cost {
        phases,
        captures,
        time,
    })
}
