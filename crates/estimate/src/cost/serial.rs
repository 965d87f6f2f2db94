//! Programs whose captures happen one after the other.
use stochc_ir::graph::EventId;
use stochc_ir::table::PhaseId;

use super::capture_states::unsupported_feature;
use super::events::{Events, ProgramParts};
use super::waits::{CaptureWait, waits};
use crate::{Rates, Wait};

/// Capture of a program whose faces open one after the other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SerialCapture {
    /// The capture.
    pub event: EventId,
    /// Phase of the capture.
    pub phase: PhaseId,
    /// Waiting time of the face for the number of free blocks in [`reference_count`].
    wait: Wait,
    /// Ratio of the hazard to that of `wait`.
    accepted: f64,
}

impl SerialCapture {
    /// Returns the distribution of the waiting time, without rounding to whole ticks.
    pub fn wait(self) -> Wait {
        Wait {
            rate: self.wait.rate * self.accepted,
            ..self.wait
        }
    }

    /// Returns the probabilities that the face still waits after 0, 1, 2 and more ticks.
    ///
    /// The rate model computes hazards for a reference number of free blocks. At the end of a tick
    /// with an arrival, it rejects the block with probability 1 - `accepted`.
    pub fn survival(self) -> impl Iterator<Item = f64> {
        let (mut open, mut hazard) = (1.0, 0.0);
        (1_u64..).map(move |tick| {
            let before = open;
            let next = self.wait.cumulative_hazard(tick as f64);
            open *= 1.0 + self.accepted * libm::expm1(hazard - next);
            hazard = next;
            before
        })
    }
}

/// Returns the captures of a program in order. Returns `None` if two faces can be open at the same
/// time, or for an unsupported feature.
///
/// In these programs, the surroundings of a face do not change while it waits. Waiting times are
/// therefore independent, and the completion time is their sum.
pub fn serial_captures(parts: ProgramParts<'_>, rates: &Rates) -> Option<Vec<SerialCapture>> {
    let events = Events::new(parts)?;
    let graph = parts.graph;
    let has_choice = graph.edges().iter().any(|edge| edge.why.is_choice());
    if has_choice || unsupported_feature(&events).is_some() {
        return None;
    }
    let waits = waits(&events, rates);
    let count = parts.scene.free.count;
    let (mut free, mut reference) = (count, count);
    let of_free = |blocks: u32| {
        let part = f64::from(blocks) / f64::from(count.max(1));
        rates.parameters.of_free(part)
    };
    let mut captures = Vec::new();
    for phase in events.phases() {
        let mut level = 0;
        let mut in_order = events.of_phase(phase);
        in_order.sort_by_key(|event| event.level);
        if in_order.len() != graph.events_of(phase).count() {
            return None;
        }
        for event in in_order {
            if !events.is_pre_attached(phase) {
                level += 1;
                let CaptureWait { wait, .. } = waits[event.id.0 as usize].as_ref()?;
                // All captures are on one chain if their levels differ.
                if event.level != level || wait.rate <= 0.0 {
                    return None;
                }
                let accepted = of_free(free) / of_free(reference);
                captures.push(SerialCapture {
                    event: event.id,
                    phase,
                    wait: Wait {
                        rate: wait.rate / accepted,
                        ..*wait
                    },
                    accepted,
                });
            }
            free = free.checked_sub(1)?;
            reference = reference_count(reference, free);
        }
    }
    Some(captures)
}

/// Returns the number of free blocks that the rate model computes hazards for. `before` is this
/// number before a change, and `free` is the number of free blocks.
pub fn reference_count(before: u32, free: u32) -> u32 {
    if (before / 2..=before).contains(&free) {
        before
    } else {
        free
    }
}
