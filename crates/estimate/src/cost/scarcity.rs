//! Free blocks, where many chains take them at the same time.
//!
//! How many are left for a face depends on how all chains fare, which only a drawing in the order of time knows ([`super::timed_phase`]).
use stochc_ir::graph::EventId;

use super::events::{Events, Step, taken};
use super::waits::CaptureWait;
use crate::{Parameters, Rates, Wait};

/// What a phase takes of the free blocks, in a program in which they are scarce.
pub struct ScarceBlocks<'a> {
    parameters: &'a Parameters,
    /// Blocks that are free at the beginning of the program.
    count: f64,
    /// How many are taken when the phase begins.
    pub before: f64,
    /// By how many blocks each step leaves fewer of them.
    pub taken: Vec<f64>,
    /// What each step would wait for if all blocks were free. `None` means nothing.
    pub waits: Vec<Option<Wait>>,
}

/// Of each phase of a program. `None` means there are enough blocks.
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
    /// How fast faces capture over how fast they would if all blocks were free. One at least is, the one that is captured.
    pub fn speed(&self, taken: f64) -> f64 {
        let left = (1.0 - taken / self.count).max(1.0 / self.count);
        self.parameters.of_free(left)
    }
}
