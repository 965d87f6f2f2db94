//! Messages under way, by the clock.
use std::collections::BTreeMap;

use super::message::Message;
use crate::world::Body;

/// The messages that are under way.
#[derive(Debug)]
pub(super) struct Post {
    /// Ticks per hop.
    hop: u64,
    /// By tick of arrival, then by order of sending: where to, and what.
    under_way: BTreeMap<(u64, u64), (Body, Message)>,
    sent: u64,
    /// Hops so far.
    pub hops: u64,
}

impl Post {
    pub fn new(hop: u64) -> Post {
        Post {
            hop,
            under_way: BTreeMap::new(),
            sent: 0,
            hops: 0,
        }
    }

    pub fn clear(&mut self) {
        self.under_way.clear();
    }

    /// Takes the next message that has arrived by `tick`, with where it is.
    pub fn due(&mut self, tick: u64) -> Option<(Body, Message)> {
        let first = self.under_way.first_entry()?;
        (first.key().0 <= tick).then(|| first.remove())
    }

    pub fn send(&mut self, tick: u64, to: Body, message: Message) {
        let key = (tick + self.hop, self.sent);
        self.sent += 1;
        self.hops += 1;
        self.under_way.insert(key, (to, message));
    }

    /// Takes back what is under way to a block, in the order of sending.
    pub fn recall(&mut self, gone: Body) -> Vec<Message> {
        let recalled = self.under_way.extract_if(.., |_, (to, _)| *to == gone);
        recalled.map(|(_, (_, message))| message).collect()
    }
}
