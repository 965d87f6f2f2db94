//! Events with their predecessors and messages, in topological order.
use rand_chacha::ChaCha8Rng;
use stochc_ir::graph::Edge;

use super::events::Events;
use super::message_times::{MessageTimes, StepMessages};

/// An event and its predecessors.
pub struct Step {
    pub event: u32,
    /// Predecessors in the same phase.
    pub before: Vec<u32>,
    /// Time between the predecessors and the event's request \[ticks\].
    pub delay: f64,
    /// Messages that the event needs. `None` if messages take no time.
    pub messages: Option<Box<StepMessages>>,
}

impl Step {
    /// Draws the duration of the report after the last event of a branch \[ticks\].
    pub fn report(&self, rng: &mut ChaCha8Rng) -> f64 {
        let messages = self.messages.as_ref();
        messages.map_or(0.0, |it| it.report(rng))
    }
}

impl Events<'_> {
    /// Returns the events of each phase in topological order.
    pub fn steps(&self) -> Vec<Vec<Step>> {
        let graph = self.parts.graph;
        let messages = MessageTimes::new(self);
        let mut steps: Vec<Vec<Step>> = self.phases().map(|_| Vec::new()).collect();
        for &id in &self.order {
            let phase = graph.event(id).phase;
            let needed = graph.waits_for(id).iter().filter(|edge| !edge.unneeded);
            let needed: Vec<&Edge> = needed.collect();
            // Pre-attached blocks need no messages.
            let messages = messages.as_ref().filter(|_| !self.is_pre_attached(phase));
            steps[phase.0 as usize].push(Step {
                event: id.0,
                delay: f64::from(graph.event(id).delay),
                messages: messages.map(|it| Box::new(it.for_event(id, &needed))),
                before: needed.iter().map(|edge| edge.first.0).collect(),
            });
        }
        steps
    }
}
