//! Messages under way, by the clock.
//!
//! A transfer needs `hop` ticks. Where the scene says that transfers are lost, both ends of a
//! contact keep [`Links`]: a sender that has no acknowledgement when the longest way there and
//! back is over, 2 `hop` + 1 ticks after it has sent, sends again. When nothing is lost, nothing is sent
//! again, and every message arrives as if there were no losses. The acknowledgement is a part of
//! the transfer, not a message of its own.
use std::collections::BTreeMap;

use stochc_ir::scene::Messages;

use super::link::Links;
use super::medium::Recalled;
use super::message::Message;
use crate::draw::{Draws, Stream, unit};
use crate::observe::{Event, Log};
use crate::world::Body;

/// The messages that are under way.
#[derive(Debug)]
pub(super) struct Post {
    /// Ticks per hop.
    hop: u64,
    /// By tick, then by order of sending.
    under_way: BTreeMap<(u64, u64), Transfer>,
    sent: u64,
    /// Hops so far, those of messages that were sent again included.
    pub hops: u64,
    /// `None`: nothing is lost.
    loss: Option<Loss>,
}

/// A message between two blocks.
#[derive(Clone, Copy, Debug)]
struct Transfer {
    from: Body,
    to: Body,
    message: Message,
    /// Its number on the contact; 0 where nothing is lost.
    number: u32,
    /// It is not the message that comes now, but the time for the sender to send it again.
    is_reminder: bool,
}

/// Chance on contacts.
#[derive(Debug)]
struct Loss {
    /// Of each transfer, and of each acknowledgement.
    probability: f64,
    draws: Draws,
    links: Links,
}

impl Post {
    /// `messages`: what the scene says of them; `seed` and `run`: the key of its chance.
    pub fn new(messages: Option<&Messages>, seed: u64, run: u64) -> Post {
        let loss = messages.and_then(|messages| messages.loss);
        Post {
            hop: messages.map_or(0, |messages| u64::from(messages.hop)),
            under_way: BTreeMap::new(),
            sent: 0,
            hops: 0,
            loss: loss.map(|probability| Loss {
                probability,
                draws: Draws::new(seed, run, Stream::Loss),
                links: Links::default(),
            }),
        }
    }

    pub fn clear(&mut self) {
        self.under_way.clear();
        if let Some(loss) = &mut self.loss {
            loss.links.clear();
        }
    }

    /// Takes the next message that has arrived by `tick`, with where it is.
    pub fn due(&mut self, tick: u64, log: &mut Log) -> Option<(Body, Message)> {
        loop {
            let first = self.under_way.first_entry()?;
            let (due, order) = *first.key();
            if due > tick {
                return None;
            }
            let transfer = first.remove();
            let Transfer { from, to, .. } = transfer;
            let Some(loss) = &mut self.loss else {
                return Some((to, transfer.message));
            };
            if transfer.is_reminder {
                if loss.links.keeps(from, to, transfer.number) {
                    let is_reminder = false;
                    self.depart(
                        tick,
                        Transfer {
                            is_reminder,
                            ..transfer
                        },
                        log,
                    );
                }
                continue;
            }
            let [there, back, ..] = loss.draws.step(order).block(0);
            let is_lost = |word| unit(word) < loss.probability;
            let (lost, unheard) = (is_lost(there), is_lost(back));
            let is_new = !lost && loss.links.take(from, to, transfer.number);
            if lost || unheard {
                let key = (due + self.hop + 1, order);
                let is_reminder = true;
                self.under_way.insert(
                    key,
                    Transfer {
                        is_reminder,
                        ..transfer
                    },
                );
            } else {
                loss.links.acknowledge(from, to, transfer.number);
            }
            if is_new {
                return Some((to, transfer.message));
            }
        }
    }

    pub fn send(&mut self, tick: u64, from: Body, to: Body, message: Message, log: &mut Log) {
        let loss = self.loss.as_mut();
        let number = loss.map_or(0, |loss| loss.links.send(from, to, message));
        let transfer = Transfer {
            from,
            to,
            message,
            number,
            is_reminder: false,
        };
        self.depart(tick, transfer, log);
    }

    fn depart(&mut self, tick: u64, transfer: Transfer, log: &mut Log) {
        log.note(Event::Sent {
            from: transfer.from,
            to: transfer.to,
            said: transfer.message.payload.said(),
        });
        let key = (tick + self.hop, self.sent);
        self.sent += 1;
        self.hops += 1;
        self.under_way.insert(key, transfer);
    }

    /// Takes out what is under way to a block or from it.
    pub fn recall(&mut self, gone: Body) -> Recalled {
        let touches = |transfer: &mut Transfer| transfer.from == gone || transfer.to == gone;
        let transfers = self
            .under_way
            .extract_if(.., |_, transfer| touches(transfer));
        let transfers: Vec<Transfer> = transfers.map(|(_, transfer)| transfer).collect();
        if let Some(loss) = &mut self.loss {
            return loss.links.close(gone);
        }
        let mut recalled = Recalled::default();
        for transfer in transfers {
            if transfer.to == gone {
                recalled.to.push(transfer.message);
            } else {
                recalled.from.push(transfer.message);
            }
        }
        recalled
    }
}
