//! Event times of a program in one random sample.
use rand_chacha::ChaCha8Rng;

use super::partial_run::PartialRun;
use super::steps::Step;

/// Mark of an event that waited for no other event of its phase.
pub const NO_BLOCK: u32 = u32::MAX;

/// Event times of a program in one random sample.
pub struct DrawnTimes {
    /// Earliest possible time of each event \[ticks\].
    pub starts: Vec<f64>,
    /// Time of each event \[ticks\]. Infinite if the event has not happened.
    pub ends: Vec<f64>,
    /// For each event, the last event of the same phase that it waited for. [`NO_BLOCK`] if none.
    pub last: Vec<u32>,
    /// For each release, whether a face nearby has captured the released block.
    pub is_taken: Vec<bool>,
}

impl DrawnTimes {
    /// Creates a sample for this number of events. No event has happened.
    pub fn new(events: usize) -> DrawnTimes {
        DrawnTimes {
            starts: vec![0.0; events],
            ends: vec![f64::INFINITY; events],
            last: vec![NO_BLOCK; events],
            is_taken: vec![false; events],
        }
    }

    /// Resets all events.
    pub fn clear(&mut self) {
        self.ends.fill(f64::INFINITY);
        self.is_taken.fill(false);
    }

    /// Resets the events of a phase that begins again.
    pub fn begin_again(&mut self, steps: &[Step]) {
        for step in steps {
            self.ends[step.event as usize] = f64::INFINITY;
            self.is_taken[step.event as usize] = false;
        }
    }

    /// Records an event that happened at a known tick.
    pub fn set(&mut self, event: u32, tick: f64) {
        let at = event as usize;
        (self.starts[at], self.ends[at], self.last[at]) = (tick, tick, NO_BLOCK);
    }

    pub fn has_happened(&self, event: u32) -> bool {
        self.ends[event as usize].is_finite()
    }

    /// Computes the earliest possible time of a step \[ticks\]. All its predecessors must have
    /// happened. The phase starts at `began`. If `partial` is given, its run continues.
    pub fn begin(
        &mut self,
        step: &Step,
        began: f64,
        partial: Option<&PartialRun>,
        rng: &mut ChaCha8Rng,
    ) -> f64 {
        let messages = step.messages.as_deref();
        let mut start = (began, NO_BLOCK);
        for (i, &event) in step.before.iter().enumerate() {
            let end = self.ends[event as usize];
            let arrival = messages.map_or(end, |it| it.arrival(i, end, &self.ends, rng));
            if arrival >= start.0 {
                start = (arrival, event);
            }
        }
        let chosen = (step.choice.as_ref()).and_then(|choice| choice.end(&self.ends));
        if let Some(chosen) = chosen.filter(|chosen| chosen.0 >= start.0) {
            start = chosen;
        }
        start.0 += step.delay;
        start.0 += messages.map_or(0.0, |it| it.request(rng));
        if let Some(run) = partial {
            start.0 = run.start(step.event, start.0);
        }
        (
            self.starts[step.event as usize],
            self.last[step.event as usize],
        ) = start;
        start.0
    }
}
