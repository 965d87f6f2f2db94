//! What comes when, the earliest first.
use std::cmp::Ordering;
use std::collections::BinaryHeap;

use serde::{Deserialize, Serialize};

use super::race::Slot;

/// Something that may happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct ScheduledCapture {
    /// Where the face that captures is kept.
    pub slot: Slot,
    /// The opening of the face that it was meant for.
    pub opening: u64,
    /// Which block; `None`: any that is free.
    pub block: Option<u32>,
}

/// Entries by time, and of one time by their order; those that no longer hold are left in until they come first.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct CaptureQueue {
    heap: BinaryHeap<Timed>,
    pushed: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Timed {
    time: f64,
    order: u64,
    entry: ScheduledCapture,
}

impl CaptureQueue {
    /// Notes an entry for a time, unless that never comes.
    pub fn push(&mut self, time: f64, entry: ScheduledCapture) {
        if time.is_finite() {
            let order = self.pushed;
            self.pushed += 1;
            self.heap.push(Timed { time, order, entry });
        }
    }

    /// The earliest entry, with its time.
    pub fn first(&self) -> Option<(f64, ScheduledCapture)> {
        self.heap.peek().map(|timed| (timed.time, timed.entry))
    }

    /// Takes the earliest entry out.
    pub fn drop_first(&mut self) {
        self.heap.pop();
    }
}

impl Eq for Timed {}

impl Ord for Timed {
    /// The earliest is the greatest.
    fn cmp(&self, other: &Timed) -> Ordering {
        let by_time = other.time.total_cmp(&self.time);
        by_time.then_with(|| other.order.cmp(&self.order))
    }
}

impl PartialOrd for Timed {
    fn partial_cmp(&self, other: &Timed) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
