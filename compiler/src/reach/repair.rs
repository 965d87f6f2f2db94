//! Finds captures that must happen later to leave a block an access path.
use std::collections::VecDeque;

use rustc_hash::FxHashMap;
use stochc_ir::Face;

use super::analysis::ReachAnalysis;
use super::closable_phase::ClosablePhase;
use super::descendants::{DescendantIndex, Descendants};
use super::moving_cube::MovingCube;
use super::path_search::SearchOutcome;
use super::reachable::Dismantled;
use crate::SourceLocation;
use crate::expanded::EventId;
use stochc_ir::Cell;

/// Largest number of cells in the search for a path out of one pocket.
const FARTHEST: usize = 20_000;

impl ReachAnalysis<'_> {
    /// Returns a minimal set of captures that must happen after `id`, so that its cell keeps a
    /// path. Returns `None` if no path was found.
    ///
    /// `apart` is an order for removing the blocks of the phase. The returned captures are removed
    /// before `id` in this order. All results for one phase therefore agree with the reverse order.
    /// Captures written at the locations `barred` are not used.
    pub fn later(
        &mut self,
        phase: &ClosablePhase,
        apart: &Dismantled,
        id: EventId,
        barred: &[SourceLocation],
    ) -> Option<Vec<EventId>> {
        let following = phase.descendants.of(id, &mut self.remedies.steps);
        let at_worst = |other: EventId| !following.contains(other) && !phase.never.contains(&other);
        let plan = self.subject.plan;
        let stays = |other: EventId| {
            at_worst(other)
                && (!phase.descendants.has(other)
                    || apart.departure(other) > apart.departure(id)
                    || barred.contains(&plan.event(other).location))
        };
        let mut later = self.on_path(id, &at_worst, &stays)?;
        if !self.is_open_after(id, &later, phase.descendants, &at_worst) {
            return None;
        }
        let mut i = 0;
        while i < later.len() && later.len() > 1 {
            let mut fewer = later.clone();
            fewer.remove(i);
            if self.is_open_after(id, &fewer, phase.descendants, &at_worst) {
                later = fewer
            } else {
                i += 1
            }
        }
        Some(later)
    }

    /// Returns whether the cell of `id` has a path if the captures `later` and their descendants
    /// happen after `id`. All other events that do not depend on `id` happen before it.
    fn is_open_after(
        &mut self,
        id: EventId,
        later: &[EventId],
        descendants: &DescendantIndex,
        at_worst: &dyn Fn(EventId) -> bool,
    ) -> bool {
        let following: Vec<Descendants> = (later.iter())
            .map(|&other| descendants.of(other, &mut self.remedies.steps))
            .collect();
        let path = self.escape(id, &|other| {
            at_worst(other) && following.iter().all(|after| !after.contains(other))
        });
        matches!(path, SearchOutcome::Out)
    }

    /// Returns the captures whose blocks lie on the path out with the fewest blocks, in the worst
    /// order of `id`. The path avoids blocks that must stay. Returns `None` if there is no such
    /// path.
    fn on_path(
        &mut self,
        id: EventId,
        at_worst: &dyn Fn(EventId) -> bool,
        stays: &dyn Fn(EventId) -> bool,
    ) -> Option<Vec<EventId>> {
        let start = self.cell(id)?;
        self.occupancy.sort();
        let worst = MovingCube {
            occupancy: &self.occupancy,
            has: at_worst,
            size: 1,
        };
        // Finds the path with the fewest occupied cells of the worst order. Other cells cost
        // nothing.
        let mut best: FxHashMap<Cell, (u32, Cell)> = FxHashMap::from_iter([(start, (0, start))]);
        let mut queue = VecDeque::from([start]);
        while let Some(at) = queue.pop_front() {
            let cost = best[&at].0;
            if worst.sees_sky(at) {
                let mut captures = Vec::new();
                let mut at = at;
                loop {
                    captures.extend(self.occupancy.at(at).filter(|&by| by != id && at_worst(by)));
                    let (_, before) = best[&at];
                    if before == at {
                        break;
                    }
                    at = before;
                }
                captures.sort_unstable();
                captures.dedup();
                return Some(captures);
            }
            if best.len() > FARTHEST || self.remedies.is_spent() {
                return None;
            }
            self.remedies.steps += 1;
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
                if self.occupancy.is_blocked(next, stays) {
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
        None
    }
}
