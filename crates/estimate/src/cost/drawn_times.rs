//! One drawing of a program: when its events happen, and the chance in that.
use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;

use super::events::Step;

/// Nobody is before this event in its phase.
pub const NOBODY: u32 = u32::MAX;

/// When the events of a program happen, in one drawing.
pub struct DrawnTimes {
    /// When each could begin.
    pub starts: Vec<f64>,
    /// When each happened; infinite: it has not.
    pub ends: Vec<f64>,
    /// The one of its phase that each waited for last.
    pub last: Vec<u32>,
    /// Of each release, whether a face nearby has taken its block.
    pub is_taken: Vec<bool>,
}

impl DrawnTimes {
    /// Of a program with so many events, of which none has happened.
    pub fn new(events: usize) -> DrawnTimes {
        DrawnTimes {
            starts: vec![0.0; events],
            ends: vec![f64::INFINITY; events],
            last: vec![NOBODY; events],
            is_taken: vec![false; events],
        }
    }

    /// Forgets all that has happened.
    pub fn clear(&mut self) {
        self.ends.fill(f64::INFINITY);
        self.is_taken.fill(false);
    }

    /// Returns whether an event has happened.
    pub fn has_happened(&self, event: u32) -> bool {
        self.ends[event as usize].is_finite()
    }

    /// When a step can begin, of a phase that began at a time, as all that it waits for has happened.
    pub fn begin(&mut self, step: &Step, began: f64, rng: &mut ChaCha8Rng) -> f64 {
        let messages = step.messages.as_deref();
        let mut start = (began, NOBODY);
        for (i, &event) in step.before.iter().enumerate() {
            let end = self.ends[event as usize];
            let heard = messages.map_or(end, |it| it.heard(i, end, &self.ends, rng));
            if heard >= start.0 {
                start = (heard, event);
            }
        }
        start.0 += messages.map_or(0.0, |it| it.request(rng));
        (
            self.starts[step.event as usize],
            self.last[step.event as usize],
        ) = start;
        start.0
    }
}

/// Returns a draw from the exponential distribution of mean 1.
pub fn exponential(rng: &mut ChaCha8Rng) -> f64 {
    -libm::log1p(-rng.random::<f64>())
}
