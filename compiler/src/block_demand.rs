//! How many free blocks the scene has to have, so that every capture can come.
use petgraph::Direction::{self, Incoming, Outgoing};
use petgraph::graph::NodeIndex;
use rustc_hash::FxHashSet;
use stochc_grammar::{Cancellation, Cancelled};

use crate::graph::DependencyGraph;
use crate::layout::Layout;
use crate::order::Order;
use crate::plan::{EventId, EventKind, ProgramPlan};

/// Edges that are followed in search of a capture that asks for too many.
const SEARCHED: usize = 5_000_000;

/// The first capture with which, or release before which, more than `free` blocks are anchored at the same time, whatever the order,
/// and how many there are at least.
///
/// These are the blocks that the phase begins with and those of the captures that come before it for certain, less all that
/// may be let go before it. `certain`: what surely comes before what. The search is bounded, beyond which nothing is found.
///
/// # Errors
///
/// [`Cancelled`] if nobody waits for it.
pub fn first_beyond(
    plan: &ProgramPlan,
    layout: &Layout,
    certain: &DependencyGraph,
    order: &Order,
    free: u32,
    cancellation: Cancellation<'_>,
) -> Result<Option<(EventId, u32)>, Cancelled> {
    let free = free as usize;
    let mut search = Search {
        plan,
        graph: certain,
        left: SEARCHED,
        cancellation,
    };
    let mut before = 0;
    for (events, &size) in order.by_phase(plan).iter().zip(&layout.sizes) {
        let [captures, releases] = search.counted(events.iter().copied());
        if before + captures > free && releases > 0 {
            let mut earlier = 0;
            for &id in events {
                let is_capture = plan.event(id).kind != EventKind::Release;
                earlier += usize::from(is_capture);
                if before + earlier <= free {
                    continue;
                }
                let Some(after) = search.follow(id, Outgoing)? else {
                    return Ok(None);
                };
                let [_, later] = search.counted(after);
                // Such captures are no more than stand at the end of the phase.
                if is_capture && later == 0 {
                    continue;
                }
                let Some(ancestors) = search.follow(id, Incoming)? else {
                    return Ok(None);
                };
                let [needed, _] = search.counted(ancestors);
                // With its own block; or before that is let go.
                let (own, others) = match is_capture {
                    true => (1, releases - later),
                    false => (0, releases - later - 1),
                };
                let least = (before + own + needed).saturating_sub(others);
                if least > free {
                    return Ok(Some((id, least as u32)));
                }
            }
        }
        before = size as usize;
    }
    Ok(None)
}

struct Search<'a> {
    plan: &'a ProgramPlan,
    graph: &'a DependencyGraph,
    left: usize,
    cancellation: Cancellation<'a>,
}

impl Search<'_> {
    /// Captures and releases among these.
    fn counted(&self, events: impl IntoIterator<Item = EventId>) -> [usize; 2] {
        let mut counts = [0; 2];
        for id in events {
            counts[usize::from(self.plan.event(id).kind == EventKind::Release)] += 1;
        }
        counts
    }

    /// All that comes before an event, or after it; `None` if that is too much.
    fn follow(
        &mut self,
        event: EventId,
        direction: Direction,
    ) -> Result<Option<Vec<EventId>>, Cancelled> {
        let mut seen = FxHashSet::default();
        let mut found = Vec::new();
        let mut open = vec![NodeIndex::new(event.0 as usize)];
        while let Some(node) = open.pop() {
            for next in self.graph.neighbors_directed(node, direction) {
                self.cancellation.check()?;
                let Some(left) = self.left.checked_sub(1) else {
                    return Ok(None);
                };
                self.left = left;
                if seen.insert(next) {
                    found.push(self.graph[next]);
                    open.push(next);
                }
            }
        }
        Ok(Some(found))
    }
}
