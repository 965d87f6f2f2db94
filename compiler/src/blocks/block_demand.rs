//! How many free blocks the scene has to have, so that every capture can come.
use petgraph::Direction::{self, Incoming, Outgoing};
use petgraph::graph::NodeIndex;
use rustc_hash::FxHashSet;
use stochc_grammar::{Cancellation, Cancelled};

use crate::dependencies::face_turns::has_choice;
use crate::dependencies::graph::DependencyGraph;
use crate::dependencies::order::Order;
use crate::plan::{EventId, EventKind, PlanPhase, ProgramPlan};
use crate::shapes::layout::Layout;

/// Edges that are followed in search of a capture that asks for too many.
const SEARCHED: usize = 5_000_000;

/// Returns the first capture with which, or release before which, more than `free` blocks are
/// anchored at the same time, whatever the order, and how many there are at least.
///
/// These are the blocks that the phase begins with and those of the captures that come before it
/// for certain, less all that may be let go before it. `certain`: what surely comes before what.
/// The search is bounded, beyond which nothing is found.
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
    let sizes = layout.sizes.iter().map(|&size| size as usize);
    let begins: Vec<usize> = std::iter::once(0).chain(sizes).collect();
    // Nearly always there are more than all captures together take.
    let is_enough = |(phase, before): (&PlanPhase, &usize)| before + phase.events.len() <= free;
    if plan.phases.iter().zip(&begins).all(is_enough) {
        return Ok(None);
    }
    let mut search = Search {
        plan,
        graph: certain,
        left: SEARCHED,
        cancellation,
    };
    for (events, before) in order.by_phase(plan).iter().zip(begins) {
        let [captures, releases] = search.counted(events.iter().copied());
        if before + captures <= free || releases == 0 {
            continue;
        }
        let mut most = before;
        for &id in events {
            most += usize::from(plan.event(id).kind != EventKind::Release);
            if most <= free {
                continue;
            }
            let Some(least) = search.least_at(id, before, releases)? else {
                return Ok(None);
            };
            if least > free {
                return Ok(Some((id, least as u32)));
            }
        }
    }
    Ok(None)
}

/// Returns the first phase that may need more than `free` blocks at a capture, in some order.
///
/// A phase without releases needs as many as stand at its end, which is compared elsewhere. Where
/// captures choose among faces, or the search ends, the answer is the phase.
pub fn scarce_phase<'a>(
    plan: &'a ProgramPlan,
    layout: &Layout,
    graph: &DependencyGraph,
    free: u32,
) -> Option<&'a PlanPhase> {
    let free = free as usize;
    let mut search = Search {
        plan,
        graph,
        left: SEARCHED,
        cancellation: Cancellation::NEVER,
    };
    let has_choice = has_choice(graph);
    let mut before = 0;
    plan.phases
        .iter()
        .zip(&layout.sizes)
        .find_map(|(phase, &size)| {
            let [captures, releases] = search.counted(plan.events_of(phase));
            let most = std::mem::replace(&mut before, size as usize) + captures;
            if releases == 0 || most <= free {
                return None;
            }
            let mut is_enough = |id| search.most_at(id, most).is_some_and(|most| most <= free);
            (has_choice || !plan.events_of(phase).all(&mut is_enough)).then_some(phase)
        })
}

struct Search<'a> {
    plan: &'a ProgramPlan,
    graph: &'a DependencyGraph,
    left: usize,
    cancellation: Cancellation<'a>,
}

impl Search<'_> {
    /// How many blocks are anchored at least, with its own, when a capture comes, or when a block is let go; 0 if that is no more than stand at
    /// the end of the phase, and `None` if it is too much to look for.
    ///
    /// `before`: how many the phase begins with; `releases`: how many it has.
    fn least_at(
        &mut self,
        event: EventId,
        before: usize,
        releases: usize,
    ) -> Result<Option<usize>, Cancelled> {
        let is_release = self.plan.event(event).kind == EventKind::Release;
        let Some(after) = self.follow(event, Outgoing)? else {
            return Ok(None);
        };
        let [_, later] = self.counted(after);
        if later == 0 && !is_release {
            return Ok(Some(0));
        }
        let Some(ancestors) = self.follow(event, Incoming)? else {
            return Ok(None);
        };
        let [needed, _] = self.counted(ancestors);
        let gone = releases - later - usize::from(is_release);
        let anchored = before + needed + usize::from(!is_release);
        Ok(Some(anchored.saturating_sub(gone)))
    }

    /// Returns how many blocks are anchored at most once a capture has come; 0 for a release, and
    /// `None` if that takes too long. `all`: with every capture of the phase and no release.
    fn most_at(&mut self, event: EventId, all: usize) -> Option<usize> {
        if self.plan.event(event).kind == EventKind::Release {
            return Some(0);
        }
        let after = self.follow(event, Outgoing).ok()??;
        let ancestors = self.follow(event, Incoming).ok()??;
        let [later, _] = self.counted(after);
        let [_, gone] = self.counted(ancestors);
        Some(all - later - gone)
    }

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
