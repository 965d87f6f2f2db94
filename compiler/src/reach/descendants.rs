//! Descendants of the events of a phase.
//!
//! They are computed on demand, because storing them all would take too much memory. A spanning
//! forest gives most descendants of an event as one interval of a preorder. The few edges that the
//! forest does not imply add further intervals.
use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;

use super::effort::SearchEffort;
use crate::dependencies::graph::DependencyGraph;
use crate::expanded::EventId;

/// Index of descendants among the events of one phase.
pub struct DescendantIndex {
    /// Number of the phase's first event.
    first: u32,
    /// For each event of the phase, its position in the preorder.
    place: Vec<u32>,
    /// For each event of the phase, the size of its subtree in the forest, including itself.
    size: Vec<u32>,
    /// Edges that the forest does not contain: the position of the source in the preorder, and the
    /// target.
    cross: Vec<(u32, EventId)>,
}

/// An event and its descendants.
pub struct Descendants<'a> {
    descendants: &'a DescendantIndex,
    /// Intervals of the preorder, sorted and disjoint.
    intervals: Vec<(u32, u32)>,
}

impl DescendantIndex {
    /// Creates the index for the events of one phase in topological order. Their numbers are
    /// consecutive from `first`.
    pub fn new(graph: &DependencyGraph, first: u32, events: &[EventId]) -> DescendantIndex {
        let count = events.len();
        let local = |id: EventId| (id.0 - first) as usize;
        let mut rank = vec![0u32; count];
        for (i, &id) in events.iter().enumerate() {
            rank[local(id)] = i as u32;
        }
        // The parent in the forest is the last event that an event waits for.
        let node = |id: EventId| NodeIndex::new(id.0 as usize);
        let before = |id: EventId| {
            (graph.edges_directed(node(id), Incoming)).map(|edge| graph[edge.source()])
        };
        let parent = |id: EventId| before(id).max_by_key(|&first| rank[local(first)]);
        let parents: Vec<Option<EventId>> = events.iter().map(|&id| parent(id)).collect();
        let mut size = vec![1u32; count];
        for (&id, parent) in events.iter().zip(&parents).rev() {
            if let Some(parent) = parent {
                size[local(*parent)] += size[local(id)];
            }
        }
        let mut place = vec![0u32; count];
        // Position of the next child of each event.
        let mut next = vec![0u32; count];
        let mut next_root = 0;
        for (&id, parent) in events.iter().zip(&parents) {
            let slot = match parent {
                Some(parent) => &mut next[local(*parent)],
                None => &mut next_root,
            };
            place[local(id)] = *slot;
            *slot += size[local(id)];
            next[local(id)] = place[local(id)] + 1;
        }
        let mut cross = Vec::new();
        for (&id, parent) in events.iter().zip(&parents) {
            let Some(parent) = parent else { continue };
            for other in before(id) {
                let from = place[local(other)];
                let below = from..from + size[local(other)];
                if !below.contains(&place[local(*parent)]) {
                    cross.push((from, id));
                }
            }
        }
        cross.sort_unstable();
        DescendantIndex {
            first,
            place,
            size,
            cross,
        }
    }

    /// Returns whether an event belongs to the phase.
    pub fn has(&self, id: EventId) -> bool {
        id.0 >= self.first && ((id.0 - self.first) as usize) < self.place.len()
    }

    fn interval(&self, id: EventId) -> (u32, u32) {
        let i = (id.0 - self.first) as usize;
        (self.place[i], self.place[i] + self.size[i])
    }

    /// Returns an event and its descendants. `steps` counts the work.
    pub fn of(&self, id: EventId, steps: &mut u64) -> Descendants<'_> {
        let mut intervals = vec![self.interval(id)];
        self.add_cross(&mut intervals, steps, u64::MAX);
        Descendants {
            descendants: self,
            intervals,
        }
    }

    /// Returns an event and its descendants. Returns `None` if the search effort is used up.
    pub fn within(&self, id: EventId, effort: &mut SearchEffort<'_>) -> Option<Descendants<'_>> {
        let mut intervals = vec![self.interval(id)];
        self.add_cross(&mut intervals, &mut effort.steps, effort.budget);
        (!effort.is_spent()).then_some(Descendants {
            descendants: self,
            intervals,
        })
    }

    /// Adds the intervals of edges outside the forest. Stops after this many steps.
    fn add_cross(&self, intervals: &mut Vec<(u32, u32)>, steps: &mut u64, most: u64) {
        if self.cross.is_empty() {
            return;
        }
        let mut open = intervals.clone();
        while let Some((from, to)) = open.pop()
            && *steps <= most
        {
            let start = self.cross.partition_point(|&(source, _)| source < from);
            for &(source, target) in &self.cross[start..] {
                if source >= to {
                    break;
                }
                *steps += 1;
                let (from, to) = self.interval(target);
                let at = intervals.partition_point(|&(begin, _)| begin <= from);
                let known = at > 0 && intervals[at - 1].1 >= to;
                if known {
                    continue;
                }
                // Intervals of a forest are nested or disjoint.
                let inner = (intervals[at..].iter())
                    .take_while(|&&(_, end)| end <= to)
                    .count();
                *steps += inner as u64;
                intervals.splice(at..at + inner, [(from, to)]);
                open.push((from, to));
            }
        }
    }
}

impl Descendants<'_> {
    /// Returns whether the set contains an event. The event may belong to any phase.
    pub fn contains(&self, id: EventId) -> bool {
        if !self.descendants.has(id) {
            return false;
        }
        let place = self.descendants.interval(id).0;
        let at = self.intervals.partition_point(|&(from, _)| from <= place);
        at > 0 && place < self.intervals[at - 1].1
    }
}
