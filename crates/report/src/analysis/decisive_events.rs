//! Events on the critical paths of runs.
use super::critical_path::{CriticalPathSegment, SegmentKind};
use super::events::Events;

/// Accumulator of the ticks that events spend on the critical paths of runs.
#[derive(Clone, Debug)]
pub(crate) struct DecisiveEvents {
    /// Ticks of each event on the critical paths, summed over all runs.
    pub spent: Vec<f64>,
    /// For each event, the number of runs with the event on the critical path.
    pub decided: Vec<usize>,
    /// Ticks of phases whose shortest duration is on the critical path, summed over all runs.
    pub waits: Vec<PhaseWaits>,
    /// Total ticks of all runs that did not fail.
    pub total: f64,
}

/// Time on the critical paths of runs that the `wait` of one phase takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PhaseWaits {
    /// Ticks, summed over all runs.
    pub spent: f64,
    /// Number of runs with this `wait` on the critical path.
    pub decided: usize,
}

impl DecisiveEvents {
    pub fn new(events: &Events) -> DecisiveEvents {
        let count = events.events.len();
        DecisiveEvents {
            spent: vec![0.0; count],
            decided: vec![0; count],
            waits: vec![PhaseWaits::default(); events.waits.len()],
            total: 0.0,
        }
    }

    /// Adds the critical path of a run that did not fail and took `ticks`.
    pub fn add(&mut self, ticks: u64, critical_path: &[CriticalPathSegment]) {
        self.total += ticks as f64;
        for segment in critical_path {
            if let Some(event) = segment.event() {
                self.spent[event] += segment.ticks() as f64;
                self.decided[event] += 1;
            } else if segment.kind == SegmentKind::Wait {
                let wait = &mut self.waits[segment.phase.0 as usize];
                wait.spent += segment.ticks() as f64;
                wait.decided += 1;
            }
        }
    }
}
