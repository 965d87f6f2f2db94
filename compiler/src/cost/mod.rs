//! What can be said of a program's effort from its graph and geometry alone.
//!
//! Nothing here knows of speeds, fields or densities, and nothing is a time: how long a face waits depends on the crowd of
//! blocks at its height, on the ways in and on docking. The share of open directions has been held against simulated
//! waits (docs/proofs.md), and does not rank them.
mod exposure;
mod schedule;

use crate::Program;
use crate::plan::EventId;

/// What is known of a program without running it.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// The phases, in order.
    pub phases: Vec<PhaseCost>,
    /// The captures, the one with the most enclosed cell first; those of equal ones in source order.
    pub captures: Vec<CaptureCost>,
}

/// How a phase is ordered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PhaseCost {
    /// Captures of its longest serial chain.
    pub depth: u32,
    /// The most captures that are waited for side by side, if all take equally long.
    pub width: u32,
}

/// The surroundings of a capture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CaptureCost {
    /// Which.
    pub event: EventId,
    /// The part of all directions from the centre of its cell that are open, from 0 to 1.
    pub exposure: f64,
}

/// Looks at a program; `None` if it has no order.
pub fn estimate(program: &Program) -> Option<Cost> {
    let order = program.order.as_ref()?;
    let levels = schedule::levels(program, order);
    let exposures = exposure::exposures(program, &levels);
    let phases = (program.plan.phases.iter())
        .map(|phase| {
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
            }
        })
        .collect();
    let mut captures: Vec<CaptureCost> = (exposures.iter().enumerate())
        .filter_map(|(i, exposure)| {
            Some(CaptureCost {
                event: EventId(i as u32),
                exposure: (*exposure)?,
            })
        })
        .collect();
    // What rounding alone tells apart keeps the order of the source.
    let rounded = |exposure: f64| (exposure * 1e9).round() as u64;
    captures.sort_by_key(|capture| rounded(capture.exposure));
    Some(Cost { phases, captures })
}
