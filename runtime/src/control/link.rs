//! Contacts that may lose what crosses them.
//!
//! Each direction of a contact numbers its transfers. The sender keeps a message until the
//! receiver has acknowledged its number; the receiver acknowledges every number, and drops one
//! that it has taken before. So each message is taken exactly once, however often it, or its
//! acknowledgement, is lost. Who sends again, and when, is the affair of whoever drives.
use std::collections::{BTreeMap, BTreeSet};

use super::medium::Recalled;
use super::message::Message;
use crate::world::Body;

/// All contacts, each direction for itself: (from, to).
#[derive(Clone, Debug, Default)]
pub(crate) struct Links {
    links: BTreeMap<(Body, Body), Link>,
}

/// One direction of a contact: what both ends keep.
#[derive(Clone, Debug, Default)]
struct Link {
    /// The sender's next number.
    next: u32,
    /// What the sender keeps, by number.
    kept: BTreeMap<u32, Message>,
    /// The receiver has taken all numbers below this one ...
    taken_below: u32,
    /// ... and these.
    taken: BTreeSet<u32>,
}

impl Link {
    fn has_taken(&self, number: u32) -> bool {
        number < self.taken_below || self.taken.contains(&number)
    }
}

impl Links {
    /// The sender numbers a message and keeps it.
    pub fn send(&mut self, from: Body, to: Body, message: Message) -> u32 {
        let link = self.links.entry((from, to)).or_default();
        let number = link.next;
        link.next += 1;
        link.kept.insert(number, message);
        number
    }

    /// The receiver takes a transfer; `false`: it has had it before, or the contact is gone.
    pub fn take(&mut self, from: Body, to: Body, number: u32) -> bool {
        let Some(link) = self.links.get_mut(&(from, to)) else {
            return false;
        };
        if link.has_taken(number) {
            return false;
        }
        link.taken.insert(number);
        while link.taken.remove(&link.taken_below) {
            link.taken_below += 1;
        }
        true
    }

    /// The sender hears that a number has been taken, and forgets it.
    pub fn acknowledge(&mut self, from: Body, to: Body, number: u32) {
        if let Some(link) = self.links.get_mut(&(from, to)) {
            link.kept.remove(&number);
        }
    }

    /// Whether the sender still keeps a message: it has to be sent again.
    pub fn keeps(&self, from: Body, to: Body, number: u32) -> bool {
        let link = self.links.get(&(from, to));
        link.is_some_and(|link| link.kept.contains_key(&number))
    }

    /// Ends the contacts of a block that is being let go: what has been sent and not been taken.
    pub fn close(&mut self, gone: Body) -> Recalled {
        let mut recalled = Recalled::default();
        for (key, link) in (self.links).extract_if(.., |(a, b), _| *a == gone || *b == gone) {
            let open = |(number, message): (&u32, &Message)| {
                (!link.has_taken(*number)).then_some(*message)
            };
            let left = link.kept.iter().filter_map(open);
            if key.1 == gone {
                recalled.to.extend(left);
            } else {
                recalled.from.extend(left);
            }
        }
        recalled
    }

    /// Begins anew, on both sides of every contact.
    pub fn clear(&mut self) {
        self.links.clear();
    }
}
