//! Lossy contacts between blocks.
//!
//! Each direction of a contact numbers its transfers. The sender keeps a message until the receiver
//! acknowledges its number. The receiver acknowledges every number and drops duplicates. Each
//! message is thus accepted exactly once, whatever is lost. The driver of the structure decides
//! when to resend.
use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use stochc_ir::Cell;

use crate::body::Body;
use crate::machine::{Message, Recalled};

/// All contacts. Each direction (from, to) of a contact has its own channel.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Channels {
    channels: BTreeMap<(Body, Body), Channel>,
}

/// Messages in one direction of a contact, as known to the sender and to the receiver.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Channel {
    /// Number of the sender's next message.
    next: u32,
    /// Messages of the sender that wait for an acknowledgement, by number.
    stored: BTreeMap<u32, Message>,
    /// Smallest number of a message that the receiver has not accepted.
    taken_below: u32,
    /// Numbers of accepted messages that are larger than `taken_below`.
    taken: BTreeSet<u32>,
}

impl Channel {
    fn has_taken(&self, number: u32) -> bool {
        number < self.taken_below || self.taken.contains(&number)
    }
}

impl Channels {
    /// Numbers a message and stores it at the sender until it is acknowledged. Returns the number.
    pub fn send(&mut self, from: Body, to: Body, message: Message) -> u32 {
        // `close` must find both directions.
        self.channels.entry((to, from)).or_default();
        let channel = self.channels.entry((from, to)).or_default();
        let number = channel.next;
        channel.next += 1;
        channel.stored.insert(number, message);
        number
    }

    /// Accepts a message at the receiver. Returns `false` if the message is a duplicate or the
    /// contact is closed.
    pub fn take(&mut self, from: Body, to: Body, number: u32) -> bool {
        let Some(channel) = self.channels.get_mut(&(from, to)) else {
            return false;
        };
        if channel.has_taken(number) {
            return false;
        }
        channel.taken.insert(number);
        while channel.taken.remove(&channel.taken_below) {
            channel.taken_below += 1;
        }
        true
    }

    /// Processes an acknowledgement. The sender drops the message with this number.
    pub fn acknowledge(&mut self, from: Body, to: Body, number: u32) {
        if let Some(channel) = self.channels.get_mut(&(from, to)) {
            channel.stored.remove(&number);
        }
    }

    /// Returns whether the sender still keeps a message, which must then be resent.
    pub fn stores(&self, from: Body, to: Body, number: u32) -> bool {
        let channel = self.channels.get(&(from, to));
        channel.is_some_and(|channel| channel.stored.contains_key(&number))
    }

    /// Closes the contacts of the block `left`, which is being released. Returns the messages that
    /// were sent but not accepted.
    pub fn close(&mut self, left: Body) -> Recalled {
        let first = (left, Body::Seed(Cell::new(i32::MIN, i32::MIN, i32::MIN)));
        let from_left = self
            .channels
            .range(first..)
            .take_while(|((from, _), _)| *from == left);
        let neighbours: Vec<Body> = from_left.map(|((_, to), _)| *to).collect();
        let mut take = |from, to| {
            let Channel {
                stored,
                taken_below,
                taken,
                ..
            } = self.channels.remove(&(from, to)).unwrap_or_default();
            let is_open = move |number: &u32| *number >= taken_below && !taken.contains(number);
            stored
                .into_iter()
                .filter(move |(number, _)| is_open(number))
                .map(|(_, message)| message)
        };
        let mut recalled = Recalled::default();
        for other in neighbours {
            recalled.to.extend(take(other, left));
            recalled.from.extend(take(left, other));
        }
        recalled
    }

    /// Resets both ends of every contact.
    pub fn clear(&mut self) {
        self.channels.clear();
    }
}
