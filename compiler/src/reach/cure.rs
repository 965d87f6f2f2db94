//! An order that keeps every way open, and what has to be said for it.
use std::collections::VecDeque;

use petgraph::Direction::{Incoming, Outgoing};
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use rustc_hash::FxHashMap;
use stochc_grammar::Face;

use super::descent::Descent;
use super::sealed::Stuck;
use super::way::Search;
use super::{Cell, EventId, Survey};

/// What becomes of a stuck capture.
pub enum Cure {
    /// It has a way out if these captures come after it.
    Later(Vec<EventId>),
    /// No order of the phase gives it a way out.
    None,
    /// Not looked for.
    Unknown,
}

/// Cells looked at on the way out of one pocket.
const FARTHEST: usize = 20_000;

impl Survey<'_> {
    /// For each stuck capture of a phase without releases, what cures it.
    ///
    /// The structure is taken apart again, the last block first. Taking away only opens ways, so
    /// what can be taken now can be taken later, and a greedy search finds an order if there is one.
    /// All cures agree with that one order, so they never form a circle.
    pub fn cures(&mut self, events: &[EventId], descent: &Descent, stuck: &[Stuck]) -> Vec<Cure> {
        let first = events.iter().map(|id| id.0).min().unwrap_or(0);
        let local = |id: EventId| (id.0 - first) as usize;
        let graph = self.subject.straight;
        let after = |id: EventId| {
            (graph.edges_directed(NodeIndex::new(id.0 as usize), Outgoing))
                .map(|edge| graph[edge.target()])
        };
        let before = |id: EventId| {
            (graph.edges_directed(NodeIndex::new(id.0 as usize), Incoming))
                .map(|edge| graph[edge.source()])
        };
        let mut is_there = vec![true; events.len()];
        let mut waiting: Vec<usize> = vec![0; events.len()];
        for &id in events {
            waiting[local(id)] = after(id).count();
        }
        let mut cures: Vec<Cure> = stuck.iter().map(|_| Cure::None).collect();
        loop {
            // All that can go without asking.
            for &id in events.iter().rev() {
                if is_there[local(id)] && waiting[local(id)] == 0 && self.is_safe[id.0 as usize] {
                    is_there[local(id)] = false;
                    before(id).for_each(|first| waiting[local(first)] -= 1);
                }
            }
            let mut has_gone = false;
            for (stuck, cure) in stuck.iter().zip(&mut cures) {
                let id = stuck.capture;
                if !is_there[local(id)] || waiting[local(id)] > 0 {
                    continue;
                }
                let has = |other: EventId| !descent.has(other) || is_there[local(other)];
                match self.openings(id, descent, &has) {
                    Cure::None => continue,
                    found => *cure = found,
                }
                is_there[local(id)] = false;
                before(id).for_each(|first| waiting[local(first)] -= 1);
                has_gone = true;
            }
            if !has_gone {
                return cures;
            }
        }
    }

    /// The fewest captures that have to be missing for a way out, of those that `has` misses.
    fn openings(&mut self, id: EventId, descent: &Descent, has: &dyn Fn(EventId) -> bool) -> Cure {
        let Some(start) = self.cell(id) else {
            return Cure::None;
        };
        self.standing.sort();
        let following = descent.of(id, &mut self.proof.steps);
        let has_at_worst = |other: EventId| !following.contains(other);
        let worst = Search {
            standing: &self.standing,
            has: &has_at_worst,
            size: 1,
        };
        // Shortest way by cells that are full at worst: the others cost nothing.
        let mut best: FxHashMap<Cell, (u32, Cell)> = FxHashMap::from_iter([(start, (0, start))]);
        let mut queue = VecDeque::from([start]);
        while let Some(at) = queue.pop_front() {
            let cost = best[&at].0;
            if worst.sees_sky(at) {
                return Cure::Later(self.on_the_way(at, &best, &has_at_worst, descent));
            }
            if best.len() > FARTHEST {
                return Cure::Unknown;
            }
            self.proof.steps += 1;
            let mut reach = |next: Cell, extra: u32| {
                let cost = cost + extra;
                if best.get(&next).is_some_and(|&(known, _)| known <= cost) {
                    return;
                }
                best.insert(next, (cost, at));
                if extra == 0 {
                    queue.push_front(next);
                } else {
                    queue.push_back(next);
                }
            };
            for next in Face::ALL.into_iter().filter_map(|face| at.across(face)) {
                if self.standing.is_blocked(next, has) {
                    continue;
                }
                let is_full = worst.is_blocked(next);
                if is_full || worst.is_at_wall(next) {
                    reach(next, u32::from(is_full));
                }
            }
            if !worst.is_blocked(at)
                && let Some(under) = worst.rise(at)
            {
                reach(under, 0);
            }
        }
        Cure::None
    }

    /// The captures on a way, without those that wait for another one of them anyway.
    fn on_the_way(
        &self,
        mut at: Cell,
        best: &FxHashMap<Cell, (u32, Cell)>,
        has: &dyn Fn(EventId) -> bool,
        descent: &Descent,
    ) -> Vec<EventId> {
        let mut captures = Vec::new();
        loop {
            if let Some(by) = self.standing.at(at).filter(|&by| has(by)) {
                captures.push(by);
            }
            let (_, before) = best[&at];
            if before == at {
                break;
            }
            at = before;
        }
        captures.sort_unstable();
        captures.dedup();
        let mut steps = 0;
        let all = captures.clone();
        captures.retain(|&id| {
            (all.iter()).all(|&other| other == id || !descent.of(other, &mut steps).contains(id))
        });
        captures
    }
}
