//! Events with their predecessors and messages, in topological order.
use rand_chacha::ChaCha8Rng;
use stochc_ir::graph::{Dependency, Edge};

use super::events::Events;
use super::message_times::{MessageTimes, StepMessages};

/// An event and its predecessors.
pub struct Step {
    pub event: u32,
    /// Predecessors in the same phase. The event waits for all of them.
    pub before: Vec<u32>,
    /// Captures that can free a magnet for the event. It waits for some of them. `None` if it waits
    /// for none, or for all of them.
    pub choice: Option<Choice>,
    /// Time between the predecessors and the event's request \[ticks\].
    pub delay: f64,
    /// Messages that the event needs. `None` if messages take no time.
    pub messages: Option<Box<StepMessages>>,
}

/// Events of the same phase. Another event waits for some of them. They send no messages, because
/// their block is the block that waits.
pub struct Choice {
    pub events: Vec<u32>,
    /// Number of these events that must happen first.
    pub needed: u32,
}

impl Choice {
    /// Returns the choice of an event with these dependencies.
    fn new(edges: &[Edge]) -> Option<Choice> {
        let needed = edges.iter().find_map(|edge| match edge.why {
            Dependency::Face { needed, of } if needed < of => Some(needed),
            _ => None,
        });
        let events = edges.iter().filter(|edge| edge.why.is_choice());
        let events: Vec<u32> = events.map(|edge| edge.first.0).collect();
        Some(Choice {
            needed: u32::from(needed?).min(events.len() as u32),
            events,
        })
    }

    /// Returns the time when enough events have happened, and the last of them. `ends` contains
    /// the times of all events.
    pub fn end(&self, ends: &[f64]) -> Option<(f64, u32)> {
        let mut times: Vec<(f64, u32)> = (self.events.iter())
            .map(|&event| (ends[event as usize], event))
            .collect();
        times.sort_by(|a, b| a.0.total_cmp(&b.0));
        times.get(self.needed.checked_sub(1)? as usize).copied()
    }
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
            let edges = graph.waits_for(id);
            let needed = edges.iter().filter(|edge| !edge.why.is_choice());
            let needed: Vec<&Edge> = needed.collect();
            // Pre-attached blocks need no messages.
            let messages = messages.as_ref().filter(|_| !self.is_pre_attached(phase));
            steps[phase.0 as usize].push(Step {
                event: id.0,
                delay: f64::from(graph.event(id).delay),
                messages: messages.map(|it| Box::new(it.for_event(id, &needed))),
                before: needed.iter().map(|edge| edge.first.0).collect(),
                choice: Choice::new(edges),
            });
        }
        steps
    }
}
