//! Scarcity of free blocks, if many chains capture at the same time.
//!
//! The number of free blocks at a capture depends on the progress of all chains. Only a simulation
//! in the order of time provides it ([`super::timed_phase`]).
use stochc_ir::graph::EventId;

use super::events::{Events, taken};
use super::steps::Step;
use super::waits::CaptureWait;
use crate::{Parameters, Rates, Wait};

/// Data about the free blocks in one phase of a program with scarce blocks.
pub struct ScarceBlocks<'a> {
    parameters: &'a Parameters,
    /// Number of free blocks at the start of the program.
    count: f64,
    /// Number of bound blocks at the start of the phase.
    pub before: f64,
    /// For each step, the decrease of the number of free blocks.
    pub taken: Vec<f64>,
    /// For each step, its waiting time if all blocks were free. `None` for steps without a wait.
    pub waits: Vec<Option<Wait>>,
}

/// Returns the use of free blocks by each phase. Returns `None` if blocks are not scarce.
pub fn scarce_blocks<'a>(
    events: &Events<'_>,
    steps: &[Vec<Step>],
    waits: &[Option<CaptureWait>],
    rates: &'a Rates,
) -> Option<Vec<ScarceBlocks<'a>>> {
    if !waits.iter().flatten().any(|wait| wait.is_scarce) {
        return None;
    }
    let parameters = &rates.parameters;
    let taken = |step: &Step| taken(events.is_capture(EventId(step.event))) as f64;
    let full = |step: &Step| {
        let CaptureWait { wait, free, .. } = waits[step.event as usize].as_ref()?;
        Some(Wait {
            rate: wait.rate / parameters.of_free(*free),
            ..*wait
        })
    };
    let mut before = 0.0;
    let phases = steps.iter().map(|steps| {
        let blocks = ScarceBlocks {
            parameters,
            count: f64::from(events.parts.scene.free.count.max(1)),
            before,
            taken: steps.iter().map(taken).collect(),
            waits: steps.iter().map(full).collect(),
        };
        before += blocks.taken.iter().sum::<f64>();
        blocks
    });
    Some(phases.collect())
}

impl ScarceBlocks<'_> {
    /// Returns the capture rate relative to the rate with all blocks free. `taken` blocks are
    /// bound. Counts at least one free block, which the capture needs.
    pub fn speed(&self, taken: f64) -> f64 {
        let left = (1.0 - taken / self.count).max(1.0 / self.count);
        self.parameters.of_free(left)
    }
}
