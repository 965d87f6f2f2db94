//! What each event of a phase waits for, and for how long a phase may.
use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use rand_chacha::ChaCha8Rng;

use super::message_times::{MessageTimes, StepMessages};
use crate::Program;
use crate::graph::LocatedDependency;
use crate::order::{Order, needed};
use crate::plan::{EventId, Timeout};

/// Ticks after which each phase has failed.
pub fn timeouts(program: &Program) -> Vec<f64> {
    let tick = program.scene.as_ref().map_or(1.0, |scene| scene.tick);
    let of = |timeout: Timeout| timeout.ticks(tick) as f64;
    let phases = program.plan.phases.iter();
    phases
        .map(|phase| phase.timeout.map_or(f64::INFINITY, of))
        .collect()
}

/// An event, and what it waits for.
pub struct Step {
    pub event: u32,
    /// Of its phase.
    pub before: Vec<u32>,
    /// `None`: no message takes any time.
    pub messages: Option<Box<StepMessages>>,
}

impl Step {
    /// How long its phase takes to hear that it was the last \[tick\].
    pub fn report(&self, rng: &mut ChaCha8Rng) -> f64 {
        let messages = self.messages.as_ref();
        messages.map_or(0.0, |it| it.report(rng))
    }
}

/// The events of each phase, each behind what it waits for.
pub fn steps(program: &Program, order: &Order) -> Vec<Vec<Step>> {
    let phases = &program.plan.phases;
    let messages = MessageTimes::new(program);
    let mut steps: Vec<Vec<Step>> = phases.iter().map(|_| Vec::new()).collect();
    for &id in &order.events {
        let Some(phase) = program.plan.phase_of(id) else {
            continue;
        };
        let node = NodeIndex::new(id.0 as usize);
        let before = needed(&program.graph, &order.unneeded, node, Incoming)
            .map(|edge| (EventId(edge.source().index() as u32), *edge.weight()))
            .filter(|(event, _)| phases[phase].events.contains(&event.0));
        let before: Vec<(EventId, LocatedDependency)> = before.collect();
        // Those who attach blocks by hand send none.
        let messages = (messages.as_ref()).filter(|_| !phases[phase].planted);
        steps[phase].push(Step {
            event: id.0,
            messages: messages.map(|it| Box::new(it.of_event(id, phase, before.iter().copied()))),
            before: before.into_iter().map(|(event, _)| event.0).collect(),
        });
    }
    steps
}
