//! What comes when, the earliest first.
use std::cmp::Reverse;
use std::collections::BinaryHeap;

use serde::{Deserialize, Serialize};

use super::open_face_hazards::Slot;
use super::tournament::{NONE, Tournament};

/// Something that may happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ScheduledCapture {
    /// The face that is kept there captures any block.
    OfAny(Slot),
    /// Or one that was let go near it.
    HeadStart(ScheduledHeadStart),
}

/// A block that was let go near an open face is there first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub(super) struct ScheduledHeadStart {
    /// Where the face is kept.
    pub slot: Slot,
    /// The opening of the face that it was meant for.
    pub opening: u64,
    /// Which block.
    pub block: u32,
}

/// The captures of all open faces, and head starts. Of two at one time, that comes first which was noted first.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct EventQueue {
    /// Moments, by the slots of the faces.
    captures: Tournament,
    /// Those that no longer hold are left in until they come first.
    head_starts: BinaryHeap<Reverse<(u128, ScheduledHeadStart)>>,
    noted: u32,
}

/// A time, how many were noted before it, and the slot of a face, so that earlier is less: the bits of times that are
/// not negative are in their order.
fn moment(time: f64, order: u32, slot: Slot) -> u128 {
    u128::from(time.to_bits()) << 64 | u128::from(order) << 32 | u128::from(slot)
}

/// The time of a [`moment`].
fn time(moment: u128) -> f64 {
    f64::from_bits((moment >> 64) as u64)
}

/// The slot of a [`moment`].
fn slot(moment: u128) -> Slot {
    moment as Slot
}

impl EventQueue {
    /// Notes when the face in a slot captures, instead of what was said of that before.
    pub fn note(&mut self, slot: Slot, time: f64) {
        let moment = if time.is_finite() {
            moment(time, self.order(), slot)
        } else {
            NONE
        };
        self.captures.set(slot as usize, moment);
    }

    /// The face in a slot captures later than was said, and comes before and after the same others of that time.
    pub fn put_off(&mut self, slot: Slot, time: f64) {
        let order = (self.captures.get(slot as usize) >> 32) as u32;
        let moment = moment(time, order, slot);
        self.captures.set(slot as usize, moment);
    }

    /// The face in a slot captures nothing.
    pub fn forget(&mut self, slot: Slot) {
        if self.captures.get(slot as usize) != NONE {
            self.captures.set(slot as usize, NONE);
        }
    }

    /// Notes a head start.
    pub fn note_head_start(&mut self, time: f64, start: ScheduledHeadStart) {
        let moment = moment(time, self.order(), start.slot);
        self.head_starts.push(Reverse((moment, start)));
    }

    /// The earliest, with its time.
    pub fn first(&self) -> Option<(f64, ScheduledCapture)> {
        let first = self.captures.first();
        match self.head_starts.peek() {
            Some(&Reverse((moment, start))) if moment < first => {
                Some((time(moment), ScheduledCapture::HeadStart(start)))
            }
            _ if first == NONE => None,
            _ => Some((time(first), ScheduledCapture::OfAny(slot(first)))),
        }
    }

    /// The time of what comes after the capture in a slot, which is the earliest; never, if nothing does.
    pub fn second(&self, slot: Slot) -> f64 {
        let start = self.head_starts.peek();
        let start = start.map_or(NONE, |Reverse((moment, _))| *moment);
        match self.captures.second(slot as usize).min(start) {
            NONE => f64::INFINITY,
            second => time(second),
        }
    }

    /// Takes the earliest head start out.
    pub fn drop_head_start(&mut self) {
        self.head_starts.pop();
    }

    fn order(&mut self) -> u32 {
        let order = self.noted;
        self.noted = order.wrapping_add(1);
        order
    }
}
