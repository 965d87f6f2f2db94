//! Delays by the messages that the order of a program needs: notifications, requests for
//! release, reports to the plate. Messages travel along bonds, hop by hop. The event tables
//! determine the senders.
use rand_chacha::ChaCha8Rng;
use stochc_ir::graph::{Dependency, Edge, EventId};
use stochc_ir::scene::Messages;
use stochc_ir::table::PhaseId;

use super::events::{Block, Events, NamedBlock};
use super::exponential::exponential;

/// Largest length of [`MessagePath::handed_to`]. A limit is sufficient: in a growing tower, the
/// lower blocks are captured long before a notification arrives.
const MAX_HANDED: usize = 64;

/// Messages that an event needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepMessages {
    /// Path of the notification about each predecessor.
    notifications: Vec<MessagePath>,
    /// Number of hops of the request for release. 0 for a capture.
    request: u32,
    /// Number of hops of the report after the last event of a branch. 0 for other events.
    report: u32,
    hop: HopTime,
}

impl StepMessages {
    /// Draws the time when the notification about a predecessor arrives \[ticks\]. The predecessor
    /// is given by `index` and happened at `happened`. `ends` contains the times of all events.
    pub fn arrival(&self, index: usize, happened: f64, ends: &[f64], rng: &mut ChaCha8Rng) -> f64 {
        let path = &self.notifications[index];
        let mut at = happened + self.hop.draw(path.hops, rng);
        for &capture in &path.handed_to {
            at = at.max(ends[capture as usize]) + self.hop.draw(1, rng);
        }
        at
    }

    /// Draws the duration of the block's request for release \[ticks\].
    pub fn request(&self, rng: &mut ChaCha8Rng) -> f64 {
        self.hop.draw(self.request, rng)
    }

    /// Draws the duration of the report after the last event of a branch \[ticks\].
    pub fn report(&self, rng: &mut ChaCha8Rng) -> f64 {
        self.hop.draw(self.report, rng)
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct HopTime {
    /// Duration without loss \[ticks\].
    whole: f64,
    /// Probability that a message is lost in a hop. A lost message is sent again after 2 h + 1
    /// ticks, where h is the duration of a hop.
    loss: f64,
}

impl HopTime {
    fn new(messages: &Messages) -> HopTime {
        HopTime {
            whole: f64::from(messages.hop),
            loss: messages.loss.unwrap_or(0.0),
        }
    }

    /// Draws the duration of several consecutive hops \[ticks\].
    fn draw(self, hops: u32, rng: &mut ChaCha8Rng) -> f64 {
        let mut time = self.whole * f64::from(hops);
        if self.loss > 0.0 {
            let per_loss = libm::log(self.loss);
            for _ in 0..hops {
                // The number of losses is geometric: an exponential draw, rounded down.
                let losses = (-exponential(rng) / per_loss).floor();
                time += losses * (2.0 * self.whole + 1.0);
            }
        }
        time
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
struct MessagePath {
    /// Number of hops between existing blocks.
    hops: u32,
    /// Captures that anchor the last blocks of the path, in order, at most [`MAX_HANDED`]. The
    /// notification waits at each parent until the next block of the path is captured.
    handed_to: Vec<u32>,
}

/// Blocks of a program and their bonds.
pub struct MessageTimes<'a> {
    events: &'a Events<'a>,
    hop: HopTime,
    /// For each capture, the capturing block. For each release, the releasing block.
    parents: Vec<NamedBlock>,
    /// For each event, whether a later event of the same branch follows. Only the last event of a
    /// branch reports.
    is_followed: Vec<bool>,
    /// For each capture, the number of hops from its block to the plate.
    depths: Vec<u32>,
    /// For each capture, a distant ancestor of its block. These ancestors allow finding the common
    /// ancestor of two blocks in logarithmic time.
    ///
    /// # Source
    ///
    /// E. W. Myers, Information Processing Letters 17 (1983), 241-248.
    jumps: Vec<Block>,
}

impl<'a> MessageTimes<'a> {
    /// Prepares the message times of a program. Returns `None` if messages take no time in the
    /// scene.
    pub fn new(events: &'a Events<'a>) -> Option<MessageTimes<'a>> {
        let hop = HopTime::new(events.parts.scene.messages.as_ref()?);
        if hop.whole <= 0.0 && hop.loss <= 0.0 {
            return None;
        }
        let graph = events.parts.graph;
        let count = graph.events.len();
        let mut is_followed = vec![false; count];
        for edge in graph.edges() {
            let expected = if events.is_capture(edge.first) {
                Dependency::Anchored
            } else {
                Dependency::Emptied
            };
            is_followed[edge.first.0 as usize] |= edge.why == expected;
        }
        let mut times = MessageTimes {
            events,
            hop,
            parents: events.actors.clone(),
            is_followed,
            depths: vec![0; count],
            jumps: vec![None; count],
        };
        times.look_through();
        Some(times)
    }

    /// Determines the parent and the depth of every block.
    fn look_through(&mut self) {
        for id in (0..self.parents.len() as u32).map(EventId) {
            if self.events.is_capture(id) {
                self.measure(id);
            } else if let Some(capture) = self.events.actors[id.0 as usize].1 {
                self.parents[id.0 as usize] = self.events.actors[capture.0 as usize];
            }
        }
    }

    /// Determines the depth of a block and its distant ancestor.
    fn measure(&mut self, block: EventId) {
        let mut path = Vec::new();
        let mut at = Some(block);
        while let Some(id) = at.filter(|id| self.depths[id.0 as usize] == 0) {
            path.push(id);
            at = self.parent(id);
        }
        for id in path.into_iter().rev() {
            let parent = self.parent(id);
            let (jump, further) = (self.jump(parent), self.jump(self.jump(parent)));
            let [near, middle, far] = [parent, jump, further].map(|it| self.depth(it));
            self.depths[id.0 as usize] = near + 1;
            self.jumps[id.0 as usize] = if near - middle == middle - far {
                further
            } else {
                parent
            };
        }
    }

    /// Returns the lowest common ancestor of two blocks. The ancestor can be one of the two blocks.
    fn common(&self, mut a: Block, mut b: Block) -> Block {
        if self.depth(a) < self.depth(b) {
            (a, b) = (b, a);
        }
        while self.depth(a) > self.depth(b) {
            let jump = self.jump(a);
            a = if self.depth(jump) >= self.depth(b) {
                jump
            } else {
                self.below(a)
            };
        }
        while a != b {
            (a, b) = if self.jump(a) == self.jump(b) {
                (self.below(a), self.below(b))
            } else {
                (self.jump(a), self.jump(b))
            };
        }
        a
    }

    /// Returns the distant ancestor of a block. The plate is its own ancestor.
    fn jump(&self, block: Block) -> Block {
        block.and_then(|id| self.jumps[id.0 as usize])
    }

    fn below(&self, block: Block) -> Block {
        block.and_then(|id| self.parent(id))
    }

    fn parent(&self, block: EventId) -> Block {
        self.parents[block.0 as usize].1
    }

    fn depth(&self, block: Block) -> u32 {
        block.map_or(0, |id| self.depths[id.0 as usize])
    }

    /// Returns the path of a notification from a block to another one in a phase.
    fn path(&self, from: Block, to: Block, phase: PhaseId) -> MessagePath {
        let common = self.common(from, to);
        let hops = self.depth(from) + self.depth(to) - 2 * self.depth(common);
        let on_path = std::iter::successors(to, |&id| self.parent(id));
        let mut handed_to: Vec<u32> = on_path
            .take_while(|&id| {
                Some(id) != common && self.events.parts.graph.event(id).phase == phase
            })
            .take(MAX_HANDED)
            .map(|id| id.0)
            .collect();
        handed_to.reverse();
        MessagePath {
            hops: hops - handed_to.len() as u32,
            handed_to,
        }
    }

    /// Returns the messages that an event needs because of these dependencies.
    pub fn for_event(&self, id: EventId, needed: &[&Edge]) -> StepMessages {
        let is_release = !self.events.is_capture(id);
        StepMessages {
            notifications: needed.iter().map(|edge| self.notification(edge)).collect(),
            request: u32::from(is_release),
            report: self.report(id, is_release),
            hop: self.hop,
        }
    }

    /// Returns the path of a notification about the first event of a dependency. It starts at the
    /// block that notices this event, and ends at the block that acts in the second event.
    fn notification(&self, edge: &Edge) -> MessagePath {
        let first = edge.first;
        let actor = self.events.actors[edge.then.0 as usize];
        let witness = self.parents[first.0 as usize];
        let needs_message = matches!(edge.why, Dependency::After | Dependency::Freed);
        // A block notices events at its own faces and its own anchoring without a notification.
        if !needs_message || actor == witness || actor.1 == Some(first) {
            return MessagePath::default();
        }
        let from = if self.events.is_capture(first) {
            Some(first)
        } else {
            witness.1
        };
        self.path(from, actor.1, self.events.parts.graph.event(first).phase)
    }

    /// Returns the number of hops of the report after the last event of a branch. Returns 0 if a
    /// later event of the branch reports.
    fn report(&self, id: EventId, is_release: bool) -> u32 {
        if self.is_followed[id.0 as usize] {
            0
        } else if is_release {
            self.depth(self.parent(id))
        } else {
            self.depth(Some(id))
        }
    }
}
