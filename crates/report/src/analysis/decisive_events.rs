//! Events on the critical paths of runs.
use super::critical_path::CriticalPathSegment;
use super::events::Events;

/// Accumulator of the ticks that events spend on the critical paths of runs.
#[derive(Clone, Debug)]
pub(crate) struct DecisiveEvents {
    /// Ticks of each event on the critical paths, summed over all runs.
    pub spent: Vec<f64>,
    /// For each event, the number of runs with the event on the critical path.
    pub decided: Vec<usize>,
    /// Total ticks of all runs that did not fail.
    pub total: f64,
}

impl DecisiveEvents {
    pub fn new(events: &Events) -> DecisiveEvents {
        let count = events.events.len();
        DecisiveEvents {
            spent: vec![0.0; count],
            decided: vec![0; count],
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
            }
        }
    }
}
