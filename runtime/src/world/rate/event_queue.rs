//! Queue of scheduled captures, the earliest first.
use std::cmp::Reverse;
use std::collections::BinaryHeap;

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
    /// Keys of all scheduled captures, as a heap: no key is less than its parent. The children of
    /// key i are the keys from [`ARITY`] i + 1 on.
    heap: Vec<u128>,
    /// Index of each slot's key in the heap. [`NOWHERE`] if the slot has no capture.
    places: Vec<u32>,
    /// Captures by head starts. Obsolete ones are removed when they come first.
    head_starts: BinaryHeap<Reverse<(u128, ScheduledHeadStart)>>,
    noted: u32,
}

/// Stands for the key of a slot without a capture.
const NONE: u128 = u128::MAX;

/// Stands for the index of a key that is not in the heap.
const NOWHERE: u32 = u32::MAX;

/// Number of children of a key in the heap. Four keys have the size of a cache line.
const ARITY: usize = 4;

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
        if slot >= self.places.len() {
            self.places.resize(slot + 1, NOWHERE);
        }
        let place = self.places[slot];
        match (place == NOWHERE, moment == NONE) {
            (true, true) => {}
            (true, false) => {
                self.heap.push(moment);
                self.settle(self.heap.len() - 1, moment);
            }
            (false, false) => self.settle(place as usize, moment),
            (false, true) => {
                self.places[slot] = NOWHERE;
                let last = self.heap.pop();
                if let Some(last) = last.filter(|_| (place as usize) < self.heap.len()) {
                    self.settle(place as usize, last);
                }
            }
        }
    }

    /// Replaces the key at an index of the heap, and restores the order.
    fn settle(&mut self, mut at: usize, moment: u128) {
        while at > 0 && moment < self.heap[(at - 1) / ARITY] {
            let parent = (at - 1) / ARITY;
            self.put(at, self.heap[parent]);
            at = parent;
        }
        while let Some(child) = self.least_child(at)
            && self.heap[child] < moment
        {
            self.put(at, self.heap[child]);
            at = child;
        }
        self.put(at, moment);
    }

    fn put(&mut self, at: usize, moment: u128) {
        self.heap[at] = moment;
        self.places[slot(moment) as usize] = at as u32;
    }

    /// Returns the index of the least child of a key.
    fn least_child(&self, at: usize) -> Option<usize> {
        let first = at * ARITY + 1;
        (first..self.heap.len().min(first + ARITY)).min_by_key(|&child| self.heap[child])
    }

    fn get(&self, slot: Slot) -> u128 {
        let place = self.places.get(slot as usize);
        let moment = place.and_then(|&place| self.heap.get(place as usize));
        moment.copied().unwrap_or(NONE)
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
        let first = self.heap.first().copied().unwrap_or(NONE);
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
        debug_assert_eq!(
            self.heap.first().map(|&first| self::slot(first)),
            Some(slot)
        );
        let other = self.least_child(0).map(|child| self.heap[child]);
        match other.unwrap_or(NONE).min(start) {
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// Compares the first two captures with those of a sorted list, after each of many changes.
    #[test]
    fn the_first_two_captures_are_the_earliest() {
        let mut dice = ChaCha8Rng::seed_from_u64(1);
        let (mut queue, mut times) = (EventQueue::default(), BTreeMap::new());
        for _ in 0..20_000 {
            let slot: Slot = dice.random_range(0..60);
            let time = f64::from(dice.random_range(0..1_000_000_u32));
            match dice.random_range(0..4) {
                0 => {
                    queue.forget(slot);
                    times.remove(&slot);
                }
                1 if times.contains_key(&slot) => {
                    queue.put_off(slot, time);
                    times.insert(slot, time);
                }
                _ => {
                    queue.note(slot, time);
                    times.insert(slot, time);
                }
            }
            let mut sorted: Vec<f64> = times.values().copied().collect();
            sorted.sort_by(f64::total_cmp);
            let first = queue.first();
            assert_eq!(first.map(|(time, _)| time), sorted.first().copied());
            if let Some((_, ScheduledCapture::OfAny(slot))) = first {
                let second = sorted.get(1).copied();
                assert_eq!(queue.second(slot), second.unwrap_or(f64::INFINITY));
            }
        }
    }
}
