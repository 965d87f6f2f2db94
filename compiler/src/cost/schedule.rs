//! How far down its phase an event stands.
use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;

use crate::Program;
use crate::order::Order;
use crate::plan::EventKind;

/// For every event, the captures of the longest chain of its phase that ends in it.
pub fn levels(program: &Program, order: &Order) -> Vec<u32> {
    let mut levels = vec![0; program.plan.events.len()];
    for &id in &order.events {
        let node = NodeIndex::new(id.0 as usize);
        let before = (program.graph.edges_directed(node, Incoming))
            .filter(|edge| !order.unneeded.contains(&edge.id()))
            .map(|edge| levels[edge.source().index()])
            .max();
        let is_capture = program.plan.event(id).kind != EventKind::Release;
        levels[id.0 as usize] = before.unwrap_or(0) + u32::from(is_capture);
    }
    levels
}
