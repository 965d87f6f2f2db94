//! How long the messages take that the order of a program needs: news between blocks, requests to be let go, reports to the plate.
//! They go along the bonds, hop by hop. The event tables say who sends which.
use rand_chacha::ChaCha8Rng;
use stochc_ir::graph::{Dependency, Edge, EventId};
use stochc_ir::scene::Messages;
use stochc_ir::table::PhaseId;

use super::drawn_times::exponential;
use super::events::{Block, Events, NamedBlock};

/// Of news for the top of a tower that is captured meanwhile, blocks that it may have to wait for: those below stand for long.
const MAX_HANDED: usize = 64;

/// The messages of an event.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StepMessages {
    /// The news of each event that is waited for.
    news: Vec<MessagePath>,
    /// Of a release: hops of the block that asks for it.
    request: u32,
    /// Hops until the phase hears that this was the last.
    report: u32,
    hop: HopTime,
}

impl StepMessages {
    /// When news number `news` is heard of what happened at a time; `ends`: when each event happens, those that it waits for at least.
    pub fn heard(&self, news: usize, happened: f64, ends: &[f64], rng: &mut ChaCha8Rng) -> f64 {
        let path = &self.news[news];
        let mut at = happened + self.hop.draw(path.hops, rng);
        for &capture in &path.handed_to {
            at = at.max(ends[capture as usize]) + self.hop.draw(1, rng);
        }
        at
    }

    /// Of a release: how long the block takes to ask for it \[tick\].
    pub fn request(&self, rng: &mut ChaCha8Rng) -> f64 {
        self.hop.draw(self.request, rng)
    }

    /// How long the phase takes to hear that this was the last \[tick\].
    pub fn report(&self, rng: &mut ChaCha8Rng) -> f64 {
        self.hop.draw(self.report, rng)
    }
}

/// How long a message takes from one block to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct HopTime {
    /// Where it does not get lost \[tick\].
    whole: f64,
    /// With this probability it does, and is sent again 2 h + 1 ticks later.
    loss: f64,
}

impl HopTime {
    fn new(messages: &Messages) -> HopTime {
        HopTime {
            whole: f64::from(messages.hop),
            loss: messages.loss.unwrap_or(0.0),
        }
    }

    /// Returns the time of so many hops, one after the other.
    fn draw(self, hops: u32, rng: &mut ChaCha8Rng) -> f64 {
        let mut time = self.whole * f64::from(hops);
        if self.loss > 0.0 {
            let per_loss = libm::log(self.loss);
            for _ in 0..hops {
                // Geometric: an exponential draw, rounded down.
                let losses = (-exponential(rng) / per_loss).floor();
                time += losses * (2.0 * self.whole + 1.0);
            }
        }
        time
    }
}

/// The path of news to a block.
#[derive(Clone, Debug, Default, PartialEq)]
struct MessagePath {
    /// The hops between blocks that are there.
    hops: u32,
    /// Then, one after the other, the captures of the phase that anchor the last blocks on the way, [`MAX_HANDED`] at most: where
    /// nobody has a name yet, news waits at the block that will capture it.
    handed_to: Vec<u32>,
}

/// The blocks of a program and the bonds between them.
pub struct MessageTimes<'a> {
    events: &'a Events<'a>,
    hop: HopTime,
    /// Of each capture: the block that captures; of each release: the one that lets go.
    parents: Vec<NamedBlock>,
    /// For each event: whether another one of its branch follows, and reports.
    is_followed: Vec<bool>,
    /// Of each capture: hops from its block to the plate.
    depths: Vec<u32>,
    /// Of each capture: a block far below its own, so that two blocks find the one they both hang on in the logarithm of their
    /// depth (E. W. Myers, Information Processing Letters 17 (1983), 241-248).
    jumps: Vec<Block>,
}

impl<'a> MessageTimes<'a> {
    /// `None`: messages take no time in the scene.
    pub fn new(events: &'a Events<'a>) -> Option<MessageTimes<'a>> {
        let hop = HopTime::new(events.parts.scene.messages.as_ref()?);
        if hop.whole <= 0.0 && hop.loss <= 0.0 {
            return None;
        }
        let graph = events.parts.graph;
        let count = graph.events.len();
        let mut is_followed = vec![false; count];
        for edge in graph.edges() {
            let goes_on = if events.is_capture(edge.first) {
                Dependency::Anchored
            } else {
                Dependency::Emptied
            };
            is_followed[edge.first.0 as usize] |= edge.why == goes_on;
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

    /// Finds the parent and the depth of every block.
    fn look_through(&mut self) {
        for id in (0..self.parents.len() as u32).map(EventId) {
            if self.events.is_capture(id) {
                self.measure(id);
            } else if let Some(capture) = self.events.actors[id.0 as usize].1 {
                self.parents[id.0 as usize] = self.events.actors[capture.0 as usize];
            }
        }
    }

    /// Counts the hops from a block to the plate, and from those that it hangs on.
    fn measure(&mut self, block: EventId) {
        let mut way = Vec::new();
        let mut at = Some(block);
        while let Some(id) = at.filter(|id| self.depths[id.0 as usize] == 0) {
            way.push(id);
            at = self.parent(id);
        }
        for id in way.into_iter().rev() {
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

    /// Returns the block that two blocks hang on, or one of them.
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

    /// Of the plate: the plate.
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

    /// Returns the way from a block to another one, which hears of it in a phase.
    fn path(&self, from: Block, to: Block, phase: PhaseId) -> MessagePath {
        let common = self.common(from, to);
        let hops = self.depth(from) + self.depth(to) - 2 * self.depth(common);
        let on_the_way = std::iter::successors(to, |&id| self.parent(id));
        let mut handed_to: Vec<u32> = on_the_way
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

    /// Those of an event, which waits for others for such reasons.
    pub fn of_event(&self, id: EventId, needed: &[&Edge]) -> StepMessages {
        let is_release = !self.events.is_capture(id);
        StepMessages {
            news: needed.iter().map(|edge| self.news(edge)).collect(),
            request: u32::from(is_release),
            report: self.report(id, is_release),
            hop: self.hop,
        }
    }

    /// From who sees an event to who waits for it.
    fn news(&self, edge: &Edge) -> MessagePath {
        let first = edge.first;
        let actor = self.events.actors[edge.then.0 as usize];
        let witness = self.parents[first.0 as usize];
        let is_told = matches!(edge.why, Dependency::After | Dependency::Freed);
        // A block sees what happens at its faces, and knows of its own anchoring.
        if !is_told || actor == witness || actor.1 == Some(first) {
            return MessagePath::default();
        }
        let from = if self.events.is_capture(first) {
            Some(first)
        } else {
            witness.1
        };
        self.path(from, actor.1, self.events.parts.graph.event(first).phase)
    }

    /// Hops of the report that an event was the last of its branch; 0: others come behind it, and report.
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
