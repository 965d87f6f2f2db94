//! Checks every capture in its worst order.
use stochc_ir::Face;

use super::analysis::ReachAnalysis;
use super::descendants::DescendantIndex;
use super::graph_paths::after;
use super::moving_cube::MovingCube;
use super::path_search::SearchOutcome;
use crate::dependencies::face_turns::is_ready;
use crate::expanded::EventId;
use stochc_ir::Cell;

/// A capture that may wait forever because its cell is closed.
pub struct BlockedCapture {
    pub capture: EventId,
    /// Whether the search proved that the worst order leaves no path. If `false`, the search
    /// reached its limit first. In the worst order, everything that does not depend on the capture
    /// happens first.
    pub is_shown: bool,
}

impl ReachAnalysis<'_> {
    /// Returns the captures of a phase without a path in their worst order, sorted by source order.
    /// In this order, everything that does not depend on the capture happens first.
    pub fn blocked(
        &mut self,
        events: &[EventId],
        descendants: &DescendantIndex,
    ) -> Vec<BlockedCapture> {
        let mut open: Vec<EventId> = (events.iter().copied())
            .filter(|&id| self.is_capture(id))
            .collect();
        let mut departed = vec![false; events.len()];
        let has_releases = open.len() < events.len();
        loop {
            if has_releases {
                self.depart_surely(events, &mut departed);
            }
            let before = open.len();
            let mut blocked = Vec::new();
            // Captures that wait for others come first, because they may show that the others are
            // safe.
            open.reverse();
            open.retain(|&id| {
                let is_safe = self.is_clearly_safe(id)
                    || self.is_safe_after_search(id, descendants, &mut blocked);
                self.is_safe[id.0 as usize] = is_safe;
                !is_safe
            });
            open.reverse();
            if open.is_empty() || !has_releases || open.len() == before {
                blocked.sort_by_key(|blocked| blocked.capture);
                return blocked;
            }
        }
    }

    /// Removes blocks whose releases wait only for captures that are known to have a path in every
    /// order.
    fn depart_surely(&mut self, events: &[EventId], departed: &mut [bool]) {
        let first = events.iter().map(|id| id.0).min().unwrap_or(0);
        let local = |id: EventId| (id.0 - first) as usize;
        let mut is_sure = vec![false; events.len()];
        for &id in events {
            let sure = is_ready(self.subject.graph, id, |first| is_sure[local(first)]);
            let is_capture = self.is_capture(id);
            is_sure[local(id)] = sure && (!is_capture || self.is_safe[id.0 as usize]);
            if is_sure[local(id)]
                && !is_capture
                && !std::mem::replace(&mut departed[local(id)], true)
            {
                self.depart(id);
            }
        }
    }

    /// Returns whether a capture has a path in every order, if this is evident without a search.
    fn is_clearly_safe(&mut self, id: EventId) -> bool {
        let Some(cell) = self.cell(id) else {
            return true;
        };
        let occupancy = &self.occupancy;
        let sees_sky = |cell: Cell| occupancy.is_clear(cell.x, cell.y, cell.z);
        if occupancy.is_top(cell)
            || Face::SIDES
                .into_iter()
                .any(|face| cell.across(face).is_some_and(sees_sky))
        {
            return true;
        }
        // A descendant captures a block in a neighbouring cell and has a path.
        after(self.subject.certain, id).any(|next| {
            self.is_safe[next.0 as usize]
                && (self.cell(next))
                    .is_some_and(|next| are_adjacent(cell, next) && !occupancy.is_retained(next))
        })
    }

    fn is_safe_after_search(
        &mut self,
        id: EventId,
        descendants: &DescendantIndex,
        blocked: &mut Vec<BlockedCapture>,
    ) -> bool {
        let Some(cell) = self.cell(id) else {
            return true;
        };
        self.occupancy.sort();
        let Some(following) = descendants.within(id, &mut self.proof) else {
            blocked.push(BlockedCapture {
                capture: id,
                is_shown: false,
            });
            return false;
        };
        let search = MovingCube {
            occupancy: &self.occupancy,
            has: &|other| !following.contains(other),
            size: 1,
        };
        let is_safe = &self.is_safe;
        let is_out = |next: EventId| is_safe[next.0 as usize] && following.contains(next);
        let path = search.find_path([cell], &is_out, &mut self.known_paths[0], &mut self.proof);
        if !matches!(path, SearchOutcome::Out) {
            blocked.push(BlockedCapture {
                capture: id,
                is_shown: matches!(path, SearchOutcome::Sealed(_)),
            });
        }
        matches!(path, SearchOutcome::Out)
    }
}

/// Returns whether two cells share a face.
pub fn are_adjacent(a: Cell, b: Cell) -> bool {
    Face::ALL.iter().any(|&face| a.across(face) == Some(b))
}
