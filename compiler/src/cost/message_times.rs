//! How long the messages take that the order of a program needs: news between blocks, requests to be let go, reports to the plate.
//! They go along the bonds, hop by hop, and who sends which is what [lowering](crate::lower) writes into the tables.
use petgraph::Direction::Outgoing;
use petgraph::graph::NodeIndex;
use rand_chacha::ChaCha8Rng;
use rustc_hash::FxHashMap;
use stochc_ir::scene::Messages;
use stochc_ir::table::RoleId;

use super::drawn_times::exponential;
use crate::Program;
use crate::graph::{LocatedDependency, anchored_by};
use crate::plan::{EventId, EventKind, PlanPhase};

/// Of news for the top of a tower that is captured meanwhile, blocks that it may have to wait for: those below stand for long.
const MAX_HANDED: usize = 64;

/// A block: the capture that anchored it; `None`: the plate.
type Block = Option<EventId>;

/// A block by one of its names: the plate has one for each seed, and tells itself what one of them sees and another one waits for.
type NamedBlock = (RoleId, Block);

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

    /// The time of so many hops, one after the other.
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
    program: &'a Program,
    hop: HopTime,
    /// Of each capture: the block that captures; of each release: the one that lets go.
    parents: Vec<NamedBlock>,
    /// Of each event: the block that it is up to.
    actors: Vec<NamedBlock>,
    /// Of each capture: hops from its block to the plate.
    depths: Vec<u32>,
    /// Of each capture: a block far below its own, so that two blocks find the one they both hang on in the logarithm of their
    /// depth (E. W. Myers, Information Processing Letters 17 (1983), 241-248).
    jumps: Vec<Block>,
}

impl<'a> MessageTimes<'a> {
    /// `None`: messages take no time in the scene.
    pub fn new(program: &'a Program) -> Option<MessageTimes<'a>> {
        let messages = program.scene.as_ref()?.messages.as_ref()?;
        let hop = HopTime::new(messages);
        if hop.whole <= 0.0 && hop.loss <= 0.0 {
            return None;
        }
        let count = program.plan.events.len();
        let mut times = MessageTimes {
            program,
            hop,
            parents: vec![(RoleId(0), None); count],
            actors: vec![(RoleId(0), None); count],
            depths: vec![0; count],
            jumps: vec![None; count],
        };
        times.look_through();
        Some(times)
    }

    /// Finds out who hangs on whom, phase by phase.
    fn look_through(&mut self) {
        let Program {
            plan,
            layout,
            graph,
            ..
        } = self.program;
        let mut held: FxHashMap<RoleId, EventId> = FxHashMap::default();
        for phase in &plan.phases {
            for id in plan.events_of(phase) {
                let actor = plan.actor(id);
                let block = anchored_by(graph, id).or_else(|| held.get(&actor).copied());
                self.actors[id.0 as usize] = (actor, block);
                self.parents[id.0 as usize] = (actor, block);
            }
            for id in plan.events_of(phase) {
                if plan.event(id).kind == EventKind::Release {
                    if let Some(on) = layout.parents[id.0 as usize] {
                        self.parents[id.0 as usize] = self.parents[on.capture.0 as usize];
                    }
                } else {
                    self.measure(id);
                    held.insert(plan.event(id).role, id);
                }
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

    /// The block that two blocks hang on, or one of them.
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

    /// The way from a block to another one, which hears of it in a phase.
    fn path(&self, from: Block, to: Block, phase: &PlanPhase) -> MessagePath {
        let common = self.common(from, to);
        let hops = self.depth(from) + self.depth(to) - 2 * self.depth(common);
        let on_the_way = std::iter::successors(to, |&id| self.parent(id));
        let mut handed_to: Vec<u32> = on_the_way
            .take_while(|&id| Some(id) != common && phase.events.contains(&id.0))
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
    pub fn of_event(
        &self,
        id: EventId,
        phase: usize,
        before: impl Iterator<Item = (EventId, LocatedDependency)>,
    ) -> StepMessages {
        let phase = &self.program.plan.phases[phase];
        let is_release = self.program.plan.event(id).kind == EventKind::Release;
        StepMessages {
            news: before
                .map(|(first, why)| self.news(first, id, why, phase))
                .collect(),
            request: u32::from(is_release),
            report: self.report(id, is_release),
            hop: self.hop,
        }
    }

    /// From who sees an event to who waits for it.
    fn news(
        &self,
        first: EventId,
        id: EventId,
        why: LocatedDependency,
        phase: &PlanPhase,
    ) -> MessagePath {
        let actor = self.actors[id.0 as usize];
        let witness = self.parents[first.0 as usize];
        // A block sees what happens at its faces, and knows of its own anchoring.
        if !why.is_told() || actor == witness || actor.1 == Some(first) {
            return MessagePath::default();
        }
        match self.program.plan.event(first).kind {
            EventKind::Capture { .. } => self.path(Some(first), actor.1, phase),
            EventKind::Release => self.path(witness.1, actor.1, phase),
        }
    }

    /// Hops of the report that an event was the last of its branch; 0: others come behind it, and report.
    fn report(&self, id: EventId, is_release: bool) -> u32 {
        let goes_on = if is_release {
            LocatedDependency::Emptied
        } else {
            LocatedDependency::Anchored
        };
        let graph = &self.program.graph;
        let mut behind = graph.edges_directed(NodeIndex::new(id.0 as usize), Outgoing);
        if behind.any(|edge| *edge.weight() == goes_on) {
            return 0;
        }
        if is_release {
            self.depth(self.parent(id))
        } else {
            self.depth(Some(id))
        }
    }
}
