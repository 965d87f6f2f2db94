//! Contacts that may lose what crosses them.
//!
//! Each direction of a contact numbers its transfers. The sender keeps a message until the
//! receiver has acknowledged its number; the receiver acknowledges every number, and drops one
//! that it has taken before. So each message is taken exactly once, however often it, or its
//! acknowledgement, is lost. Who sends again, and when, is the affair of whoever drives.
use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};
use stochc_ir::Cell;

use crate::body::Body;
use crate::machine::{Message, Recalled};

/// All contacts, each direction for itself: (from, to).
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Channels {
    channels: BTreeMap<(Body, Body), Channel>,
}

/// One direction of a contact: what both ends keep.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Channel {
    /// The sender's next number.
    next: u32,
    /// What the sender keeps, by number.
    kept: BTreeMap<u32, Message>,
    /// The receiver has taken all numbers below this one ...
    taken_below: u32,
    /// ... and these.
    taken: BTreeSet<u32>,
}

impl Channel {
    fn has_taken(&self, number: u32) -> bool {
        number < self.taken_below || self.taken.contains(&number)
    }
}

impl Channels {
    /// The sender numbers a message and keeps it.
    pub fn send(&mut self, from: Body, to: Body, message: Message) -> u32 {
        // For `close` to find both.
        self.channels.entry((to, from)).or_default();
        let channel = self.channels.entry((from, to)).or_default();
        let number = channel.next;
        channel.next += 1;
        channel.kept.insert(number, message);
        number
    }

    /// The receiver takes a transfer; `false`: it has had it before, or the contact is gone.
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

    /// The sender hears that a number has been taken, and forgets it.
    pub fn acknowledge(&mut self, from: Body, to: Body, number: u32) {
        if let Some(channel) = self.channels.get_mut(&(from, to)) {
            channel.kept.remove(&number);
        }
    }

    /// Whether the sender still keeps a message: it has to be sent again.
    pub fn keeps(&self, from: Body, to: Body, number: u32) -> bool {
        let channel = self.channels.get(&(from, to));
        channel.is_some_and(|channel| channel.kept.contains_key(&number))
    }

    /// Ends the contacts of a block that is being let go: what has been sent and not been taken.
    pub fn close(&mut self, gone: Body) -> Recalled {
        let first = (gone, Body::Seed(Cell::new(i32::MIN, i32::MIN, i32::MIN)));
        let of_gone = self
            .channels
            .range(first..)
            .take_while(|((from, _), _)| *from == gone);
        let neighbours: Vec<Body> = of_gone.map(|((_, to), _)| *to).collect();
        let mut take = |from, to| {
            let Channel {
                kept,
                taken_below,
                taken,
                ..
            } = self.channels.remove(&(from, to)).unwrap_or_default();
            let is_open = move |number: &u32| *number >= taken_below && !taken.contains(number);
            kept.into_iter()
                .filter(move |(number, _)| is_open(number))
                .map(|(_, message)| message)
        };
        let mut recalled = Recalled::default();
        for other in neighbours {
            recalled.to.extend(take(other, gone));
            recalled.from.extend(take(gone, other));
        }
        recalled
    }

    /// Begins anew, on both sides of every contact.
    pub fn clear(&mut self) {
        self.channels.clear();
    }
}
