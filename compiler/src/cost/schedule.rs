//! How far down its phase an event stands, and what shape a phase has from that.
use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;

use super::PhaseCost;
use crate::Program;
use crate::order::{Order, needed};
use crate::plan::{EventKind, PlanPhase};

/// For every event, the captures of the longest chain of its phase that ends in it.
pub fn levels(program: &Program, order: &Order) -> Vec<u32> {
    let mut levels = vec![0; program.plan.events.len()];
    for &id in &order.events {
        let node = NodeIndex::new(id.0 as usize);
        let before = needed(&program.graph, &order.unneeded, node, Incoming)
            .map(|edge| levels[edge.source().index()])
            .max();
        let is_capture = program.plan.event(id).kind != EventKind::Release;
        levels[id.0 as usize] = before.unwrap_or(0) + u32::from(is_capture);
    }
    levels
}

/// How deep and how wide a phase is; what is attached by hand is neither.
pub fn shape(program: &Program, phase: &PlanPhase, levels: &[u32]) -> PhaseCost {
    let mut counts: Vec<u32> = Vec::new();
    for id in program.plan.events_of(phase).filter(|_| !phase.planted) {
        let level = levels[id.0 as usize] as usize;
        if program.plan.event(id).kind != EventKind::Release
            && program.layout.cells[id.0 as usize].is_some()
        {
            counts.resize(counts.len().max(level + 1), 0);
            counts[level] += 1;
        }
    }
    PhaseCost {
        timed_out: 0.0,
        depth: counts.len().saturating_sub(1) as u32,
        width: counts.iter().copied().max().unwrap_or(0),
        times: None,
    }
}
