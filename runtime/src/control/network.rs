//! Messages in transit and their timing.
//!
//! A transfer takes `hop` ticks. If the scene loses transfers, both ends of a contact keep
//! [`Channels`]. A sender without an acknowledgement resends after 2 `hop` + 1 ticks, the longest
//! round trip. Loss can only delay messages: each arrives exactly once. The acknowledgement is part
//! of the transfer, not a message of its own.
use std::collections::VecDeque;

use serde::{Deserialize, Serialize};
use stochc_control::{Body, Channels, Message, Recalled};
use stochc_ir::scene::Messages;

use crate::counter_rng::{Draws, Stream, unit};
use crate::observe::{Log, ObservedEvent};

/// Messages in transit between blocks.
#[derive(Debug)]
pub(super) struct Network {
    /// Duration of a hop \[ticks\].
    hop: u64,
    /// Transfers in the order of sending, which is also the order of arrival.
    running: VecDeque<Transfer>,
    /// Transfers that depart later, sorted by time and then by `order`: scheduled messages, and
    /// messages to resend unless they are acknowledged.
    later: VecDeque<Transfer>,
    sent: u64,
    /// Number of hops so far, including resent messages.
    pub hops: u64,
    /// Loss of transfers. `None` if nothing is lost.
    loss: Option<Loss>,
}

/// A message between two blocks.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Transfer {
    /// Tick of arrival or of departure.
    due: u64,
    /// Number of transfers sent before this one.
    order: u64,
    from: Body,
    to: Body,
    message: Message,
    /// Number of the message among all messages from this sender to this receiver. 0 if no
    /// transfers are lost.
    number: u32,
}

#[derive(Debug)]
struct Loss {
    /// Probability of loss of each transfer and of each acknowledgement.
    probability: f64,
    draws: Draws,
    channels: Channels,
}

stochc_ir::state! {
    () Network;
    values: running, later, sent, hops;
    parts: loss;
    same: hop
}

stochc_ir::state! {
    () Loss;
    values: channels;
    parts: ;
    same: probability, draws
}

impl Network {
    /// Returns an empty network. `messages` are the scene's parameters; `seed` and `run` are the
    /// key of its random draws.
    pub fn new(messages: Option<&Messages>, seed: u64, run: u64) -> Network {
        let loss = messages.and_then(|messages| messages.loss);
        Network {
            hop: messages.map_or(0, |messages| u64::from(messages.hop)),
            running: VecDeque::new(),
            later: VecDeque::new(),
            sent: 0,
            hops: 0,
            loss: loss.map(|probability| Loss {
                probability,
                draws: Draws::new(seed, run, Stream::Loss),
                channels: Channels::default(),
            }),
        }
    }

    pub fn clear(&mut self) {
        self.running.clear();
        self.later.clear();
        if let Some(loss) = &mut self.loss {
            loss.channels.clear();
        }
    }

    /// Returns the tick of the next arrival or departure.
    #[inline]
    pub fn next_due(&self) -> Option<u64> {
        let arrives = self.running.front().map(|transfer| transfer.due);
        let departs = self.later.front().map(|transfer| transfer.due);
        match (arrives, departs) {
            (Some(one), Some(other)) => Some(one.min(other)),
            (one, other) => one.or(other),
        }
    }

    /// Removes the next message that has arrived by `tick`. Returns its last sender, its receiver
    /// and the message.
    #[inline]
    pub fn due(&mut self, tick: u64, log: &mut Log) -> Option<(Body, Body, Message)> {
        while !(self.running.is_empty() && self.later.is_empty()) {
            let key = |transfer: &Transfer| (transfer.due, transfer.order);
            let first = |queue: &VecDeque<Transfer>| {
                let first = queue.front().map(key);
                first.filter(|(due, _)| *due <= tick)
            };
            let (arrival, departure) = (first(&self.running), first(&self.later));
            if departure.is_some_and(|at| arrival.is_none_or(|arrival| at < arrival)) {
                let loss = self.loss.as_ref();
                let is_needed = |transfer: &Transfer| {
                    let Transfer { from, to, .. } = *transfer;
                    loss.is_none_or(|loss| loss.channels.stores(from, to, transfer.number))
                };
                if let Some(transfer) = self.later.pop_front().filter(is_needed) {
                    self.depart(tick, transfer, log);
                }
                continue;
            }
            arrival?;
            let transfer = self.running.pop_front()?;
            let Transfer {
                due,
                order,
                from,
                to,
                message,
                number,
            } = transfer;
            let Some(loss) = &mut self.loss else {
                return Some((from, to, message));
            };
            let [there, back, ..] = loss.draws.step(order).block(0);
            let is_lost = |word| unit(word) < loss.probability;
            let (lost, unheard) = (is_lost(there), is_lost(back));
            let is_new = !lost && loss.channels.take(from, to, number);
            if lost || unheard {
                let due = due + self.hop + 1;
                put_off(&mut self.later, Transfer { due, ..transfer });
            } else {
                loss.channels.acknowledge(from, to, number);
            }
            if is_new {
                return Some((from, to, message));
            }
        }
        None
    }

    pub fn send(&mut self, tick: u64, from: Body, to: Body, message: Message, log: &mut Log) {
        let transfer = self.transfer(from, to, message);
        self.depart(tick, transfer, log);
    }

    /// Sends a message after a time \[ticks\].
    pub fn send_later(&mut self, tick: u64, from: Body, to: Body, message: Message, ticks: u32) {
        let transfer = self.transfer(from, to, message);
        let due = tick.saturating_add(u64::from(ticks));
        let order = self.sent;
        let transfer = Transfer {
            due,
            order,
            ..transfer
        };
        put_off(&mut self.later, transfer);
    }

    fn transfer(&mut self, from: Body, to: Body, message: Message) -> Transfer {
        let loss = self.loss.as_mut();
        let number = loss.map_or(0, |loss| loss.channels.send(from, to, message));
        Transfer {
            due: 0,
            order: 0,
            from,
            to,
            message,
            number,
        }
    }

    /// Performs `hops` hops at once if hops take no time and nothing else is in transit. Returns
    /// whether the hops were performed.
    pub fn carry(&mut self, hops: u32) -> bool {
        let is_alone = self.hop == 0 && self.loss.is_none() && self.running.is_empty();
        if is_alone {
            self.sent += u64::from(hops);
            self.hops += u64::from(hops);
        }
        is_alone
    }

    fn depart(&mut self, tick: u64, transfer: Transfer, log: &mut Log) {
        log.note(|| ObservedEvent::Sent {
            from: transfer.from,
            to: transfer.to,
            content: transfer.message.payload.into(),
        });
        self.running.push_back(Transfer {
            due: tick + self.hop,
            order: self.sent,
            ..transfer
        });
        self.sent += 1;
        self.hops += 1;
    }

    /// Removes the transfers to and from a block. `unreceived` is the number of hops that the
    /// structure still expects at this block.
    pub fn recall(&mut self, left: Body, unreceived: u32) -> Recalled {
        let mut recalled = Recalled::default();
        if let Some(loss) = &mut self.loss {
            let stays = |transfer: &Transfer| transfer.from != left && transfer.to != left;
            self.running.retain(stays);
            self.later.retain(stays);
            return loss.channels.close(left);
        }
        if unreceived > 0 {
            self.later.retain(|transfer| transfer.from != left);
            self.running.retain(|transfer| {
                if transfer.to == left {
                    recalled.to.push(transfer.message);
                } else if transfer.from == left {
                    recalled.from.push(transfer.message);
                } else {
                    return true;
                }
                false
            });
        }
        recalled
    }
}

/// Adds a transfer to a sorted queue.
fn put_off(queue: &mut VecDeque<Transfer>, transfer: Transfer) {
    let key = |transfer: &Transfer| (transfer.due, transfer.order);
    let i = queue.partition_point(|other| key(other) <= key(&transfer));
    queue.insert(i, transfer);
}
