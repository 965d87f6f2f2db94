//! Queue of scheduled captures, the earliest first.
use std::cmp::Reverse;
use std::collections::{BTreeSet, BinaryHeap};

use serde::{Deserialize, Serialize};

use super::open_face_hazards::Slot;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ScheduledCapture {
    /// Capture of any free block by the face in this slot.
    OfAny(Slot),
    HeadStart(ScheduledHeadStart),
}

/// Scheduled capture of a block that was released near an open face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct ScheduledHeadStart {
    pub slot: Slot,
    /// Value of [`OpenFace::opening`] when the capture was scheduled.
    pub opening: u64,
    pub block: u32,
}

/// Queue of the captures of all open faces, and of captures by head starts. Events at equal times
/// keep their order of insertion.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct EventQueue {
    /// Key of the capture of each slot. [`NONE`] if the slot has no capture.
    captures: Vec<u128>,
    /// All keys except [`NONE`], in ascending order.
    sorted: BTreeSet<u128>,
    /// Captures by head starts. Obsolete ones are removed when they come first.
    head_starts: BinaryHeap<Reverse<(u128, ScheduledHeadStart)>>,
    noted: u32,
}

/// The key of a slot without a capture.
const NONE: u128 = u128::MAX;

/// Returns a sortable key from a time, an insertion number and a slot. The bits of non-negative
/// times sort like the times.
fn moment(time: f64, order: u32, slot: Slot) -> u128 {
    u128::from(time.to_bits()) << 64 | u128::from(order) << 32 | u128::from(slot)
}

/// Returns the time of a [`moment`].
fn time(moment: u128) -> f64 {
    f64::from_bits((moment >> 64) as u64)
}

/// Returns the slot of a [`moment`].
fn slot(moment: u128) -> Slot {
    moment as Slot
}

impl EventQueue {
    fn set(&mut self, slot: Slot, moment: u128) {
        let slot = slot as usize;
        if slot >= self.captures.len() {
            self.captures.resize(slot + 1, NONE);
        }
        self.sorted.remove(&self.captures[slot]);
        self.captures[slot] = moment;
        if moment != NONE {
            self.sorted.insert(moment);
        }
    }

    fn get(&self, slot: Slot) -> u128 {
        self.captures.get(slot as usize).copied().unwrap_or(NONE)
    }

    /// Sets the capture time of a slot's face.
    pub fn note(&mut self, slot: Slot, time: f64) {
        let moment = if time.is_finite() {
            moment(time, self.next_number(), slot)
        } else {
            NONE
        };
        self.set(slot, moment);
    }

    /// Moves the capture of a slot to a later time, and keeps its order among equal times.
    pub fn put_off(&mut self, slot: Slot, time: f64) {
        let order = (self.get(slot) >> 32) as u32;
        let moment = moment(time, order, slot);
        self.set(slot, moment);
    }

    /// Removes the capture of the face in a slot.
    pub fn forget(&mut self, slot: Slot) {
        if self.get(slot) != NONE {
            self.set(slot, NONE);
        }
    }

    pub fn note_head_start(&mut self, time: f64, start: ScheduledHeadStart) {
        let moment = moment(time, self.next_number(), start.slot);
        self.head_starts.push(Reverse((moment, start)));
    }

    pub fn first(&self) -> Option<(f64, ScheduledCapture)> {
        let first = self.sorted.first().copied().unwrap_or(NONE);
        match self.head_starts.peek() {
            Some(&Reverse((moment, start))) if moment < first => {
                Some((time(moment), ScheduledCapture::HeadStart(start)))
            }
            _ if first == NONE => None,
            _ => Some((time(first), ScheduledCapture::OfAny(slot(first)))),
        }
    }

    /// Returns the time of the second event. The first must be the capture in `slot`. Returns
    /// infinity if there is no second event.
    pub fn second(&self, slot: Slot) -> f64 {
        let start = self.head_starts.peek();
        let start = start.map_or(NONE, |Reverse((moment, _))| *moment);
        let other = self
            .sorted
            .iter()
            .find(|moment| self::slot(**moment) != slot);
        match other.copied().unwrap_or(NONE).min(start) {
            NONE => f64::INFINITY,
            second => time(second),
        }
    }

    /// Removes the earliest capture by a head start.
    pub fn drop_head_start(&mut self) {
        self.head_starts.pop();
    }

    fn next_number(&mut self) -> u32 {
        let number = self.noted;
        self.noted = number.wrapping_add(1);
        number
    }
}
