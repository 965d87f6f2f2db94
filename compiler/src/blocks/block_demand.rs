//! Minimum number of free blocks that the scene needs for all captures.
use petgraph::Direction::{self, Incoming, Outgoing};
use petgraph::graph::NodeIndex;
use rustc_hash::FxHashSet;
use stochc_grammar::{Cancellation, Cancelled};

use crate::dependencies::face_turns::has_choice;
use crate::dependencies::graph::DependencyGraph;
use crate::dependencies::order::Order;
use crate::expanded::{EventId, EventKind, ExpandedPhase, ExpandedProgram};
use crate::shapes::layout::Layout;

/// Largest number of edges to follow in the search for an event that needs too many blocks.
const SEARCHED: usize = 5_000_000;

/// Returns the first event that needs more than `free` anchored blocks in every order. Also returns
/// the smallest number of blocks for this event. Returns `None` if the bounded search finds no
/// event.
///
/// This number counts the blocks at the start of the phase and the blocks that ancestors of the
/// event capture. It excludes all blocks that may be released before the event. `certain` contains
/// the dependencies that hold in every order.
///
/// # Errors
///
/// [`Cancelled`] if the check was cancelled.
pub fn first_beyond(
    plan: &ExpandedProgram,
    layout: &Layout,
    certain: &DependencyGraph,
    order: &Order,
    free: u32,
    cancellation: Cancellation<'_>,
) -> Result<Option<(EventId, u32)>, Cancelled> {
    let free = free as usize;
    let sizes = layout.sizes.iter().map(|&size| size as usize);
    let begins: Vec<usize> = std::iter::once(0).chain(sizes).collect();
    // Most scenes have more free blocks than all captures together need.
    let is_enough = |(phase, before): (&ExpandedPhase, &usize)| before + phase.events.len() <= free;
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

/// Returns the first phase that can need more than `free` blocks at a capture. Returns `None` if no
/// phase can need more.
///
/// Ignores phases without releases. They have the most blocks at their end, and another check
/// compares that number. A phase with releases is also returned if the program has a choice of
/// faces, or if the search reaches its limit.
pub fn scarce_phase<'a>(
    plan: &'a ExpandedProgram,
    layout: &Layout,
    graph: &DependencyGraph,
    free: u32,
) -> Option<&'a ExpandedPhase> {
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
    plan: &'a ExpandedProgram,
    graph: &'a DependencyGraph,
    left: usize,
    cancellation: Cancellation<'a>,
}

impl Search<'_> {
    /// Returns the smallest number of anchored blocks at an event: after a capture, or before a
    /// release.
    ///
    /// Returns 0 for a capture that no release must follow. The number at the end of the phase is
    /// then at least as large. Returns `None` if the search reaches its limit. `before` is the
    /// number of blocks at the start of the phase. `releases` is the number of releases of the
    /// phase.
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
        let released = releases - later - usize::from(is_release);
        let anchored = before + needed + usize::from(!is_release);
        Ok(Some(anchored.saturating_sub(released)))
    }

    /// Returns the largest number of anchored blocks directly after the capture `event`. Returns 0
    /// for a release, and `None` if the search reaches its limit. `all` is the number of blocks
    /// after all captures of the phase without any release.
    fn most_at(&mut self, event: EventId, all: usize) -> Option<usize> {
        if self.plan.event(event).kind == EventKind::Release {
            return Some(0);
        }
        let after = self.follow(event, Outgoing).ok()??;
        let ancestors = self.follow(event, Incoming).ok()??;
        let [later, _] = self.counted(after);
        let [_, released] = self.counted(ancestors);
        Some(all - later - released)
    }

    /// Returns the numbers of captures and of releases among these events.
    fn counted(&self, events: impl IntoIterator<Item = EventId>) -> [usize; 2] {
        let mut counts = [0; 2];
        for id in events {
            counts[usize::from(self.plan.event(id).kind == EventKind::Release)] += 1;
        }
        counts
    }

    /// Returns all ancestors or all descendants of an event. Returns `None` if the search reaches
    /// its limit.
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
