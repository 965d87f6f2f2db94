//! What each event of a phase waits for, and for how long a phase may.
use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;

use crate::Program;
use crate::order::{Order, needed};
use crate::plan::Timeout;

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
}

/// The events of each phase, each behind what it waits for.
pub fn steps(program: &Program, order: &Order) -> Vec<Vec<Step>> {
    let phases = &program.plan.phases;
    let mut steps: Vec<Vec<Step>> = phases.iter().map(|_| Vec::new()).collect();
    for &id in &order.events {
        let Some(phase) = program.plan.phase_of(id) else {
            continue;
        };
        let node = NodeIndex::new(id.0 as usize);
        let before = needed(&program.graph, &order.unneeded, node, Incoming)
            .map(|edge| edge.source().index() as u32)
            .filter(|event| phases[phase].events.contains(event));
        steps[phase].push(Step {
            event: id.0,
            before: before.collect(),
        });
    }
    steps
}
