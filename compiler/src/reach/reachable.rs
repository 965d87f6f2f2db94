//! Finds the captures that can happen in some order, and one order that contains them.
use rustc_hash::FxHashSet;

use super::analysis::ReachAnalysis;
use super::descendants::DescendantIndex;
use super::graph_paths::{after, all_before, before};
use super::moving_cube::MovingCube;
use super::occupancy::Has;
use super::path_search::SearchOutcome;
use crate::dependencies::face_turns::is_ready;
use crate::dependencies::graph::DependencyGraph;
use crate::expanded::EventId;

/// Order for removing the blocks of a phase, the reverse of an order for building them.
///
/// The phase has no releases, so removing a block only opens paths. A block that can be removed now
/// can also be removed later, so the first choice does not matter. The events that a remaining
/// block waits for also remain.
pub struct Dismantled {
    first: u32,
    /// For each event of the phase, the number of events that are removed before it.
    departure: Vec<u32>,
    /// Whether all requested blocks can be removed. If so, the reverse order builds all of them.
    pub is_whole: bool,
}

/// Value of `departure` for a block that cannot be removed.
const STAYS: u32 = u32::MAX;

impl Dismantled {
    /// Returns the number of events that are removed before an event. Returns `u32::MAX` if its
    /// block cannot be removed.
    pub fn departure(&self, id: EventId) -> u32 {
        self.departure[(id.0 - self.first) as usize]
    }

    /// Returns whether an event can be removed.
    pub fn has_departed(&self, id: EventId) -> bool {
        self.departure(id) != STAYS
    }
}

impl ReachAnalysis<'_> {
    /// Searches for a path from the cell of a capture to the open sky.
    pub fn escape(&mut self, id: EventId, has: Has) -> SearchOutcome {
        let Some(cell) = self.cell(id) else {
            return SearchOutcome::Out;
        };
        self.occupancy.sort();
        let search = MovingCube {
            occupancy: &self.occupancy,
            has,
            size: 1,
        };
        search.find_path(
            [cell],
            &|_| false,
            &mut self.known_paths[0],
            &mut self.remedies,
        )
    }

    /// Returns the events of a phase that cannot happen in any order. One kind is a capture whose
    /// cell is closed by blocks that the capture waits for. The other kind is an event that waits
    /// for such a capture.
    ///
    /// Proof: suppose that one of these events happens first. Even if all possible releases have
    /// happened, the captures that it waits for surround its cell.
    pub fn never(
        &mut self,
        events: &[EventId],
        descendants: &DescendantIndex,
    ) -> FxHashSet<EventId> {
        let has_releases = events.iter().any(|&id| !self.is_capture(id));
        let saved = has_releases.then(|| {
            (
                self.occupancy.clone(),
                std::mem::take(&mut self.known_paths),
            )
        });
        let mut never: FxHashSet<EventId> = events.iter().copied().collect();
        loop {
            let (mut opens_paths, mut has_more) = (false, false);
            for &id in events {
                let is_reached = |first: EventId| !never.contains(&first);
                if is_reached(id) || !is_ready(self.subject.graph, id, is_reached) {
                    continue;
                }
                let is_capture = self.is_capture(id);
                let is_closed = is_capture
                    && !self.is_safe[id.0 as usize]
                    && matches!(
                        self.escape_past_own(id, descendants),
                        SearchOutcome::Sealed(_)
                    );
                if is_closed {
                    continue;
                }
                never.remove(&id);
                has_more = true;
                if !is_capture {
                    self.depart(id);
                    opens_paths = true;
                }
            }
            // Later events of this order may be enough for a choice.
            let is_over = !has_more || !(opens_paths || self.has_choice());
            if is_over {
                break;
            }
        }
        if let Some((occupancy, known_paths)) = saved {
            self.occupancy = occupancy;
            self.known_paths = known_paths;
        }
        never
    }

    /// Searches for a path from the cell of a capture, if only the ancestors of the capture have
    /// happened.
    pub fn escape_past_own(&mut self, id: EventId, descendants: &DescendantIndex) -> SearchOutcome {
        if self.remedies.is_spent() {
            return SearchOutcome::Unknown;
        }
        let own = all_before(self.subject.certain, [id]);
        self.remedies.steps += own.len() as u64;
        self.escape(id, &|other| {
            !descendants.has(other) || (other != id && own.contains(&other))
        })
    }

    /// Searches for an order to remove the events that `is_member` selects, in a phase without
    /// releases. The selection must include all events that a member waits for in `straight`.
    /// Returns `None` if the search was stopped.
    ///
    /// In the reverse order, all removed events can happen. `straight` is the dependency graph with
    /// one option for every choice. If an event cannot be removed, other options may be better.
    pub fn dismantle(
        &mut self,
        straight: &DependencyGraph,
        events: &[EventId],
        descendants: &DescendantIndex,
        is_member: &dyn Fn(EventId) -> bool,
    ) -> Option<Dismantled> {
        let members: Vec<EventId> = (events.iter().copied())
            .filter(|&id| is_member(id))
            .collect();
        let mut apart = Dismantled {
            first: events.iter().map(|id| id.0).min().unwrap_or(0),
            departure: vec![STAYS; events.len()],
            is_whole: false,
        };
        let local = |id: EventId| (id.0 - apart.first) as usize;
        // Number of events that must be removed first.
        let mut waiting = vec![0u32; events.len()];
        for &id in &members {
            waiting[local(id)] = after(straight, id).filter(|&next| is_member(next)).count() as u32;
        }
        let mut ready: Vec<EventId> = (members.iter().copied())
            .filter(|&id| waiting[local(id)] == 0)
            .collect();
        let mut closed: Vec<EventId> = Vec::new();
        let mut departed = 0;
        loop {
            let mut going = Vec::new();
            closed.append(&mut ready);
            closed.sort_unstable();
            // First remove blocks that need no search.
            for id in std::mem::take(&mut closed) {
                if self.is_safe[id.0 as usize] {
                    going.push(id);
                } else {
                    closed.push(id);
                }
            }
            if going.is_empty() {
                for id in std::mem::take(&mut closed) {
                    let path = self.escape(id, &|other| {
                        !descendants.has(other)
                            || (other != id && is_member(other) && !apart.has_departed(other))
                    });
                    match path {
                        SearchOutcome::Out => going.push(id),
                        SearchOutcome::Sealed(_) => closed.push(id),
                        SearchOutcome::Unknown => return None,
                    }
                }
            }
            if going.is_empty() {
                apart.is_whole = members.len() == departed as usize;
                return Some(apart);
            }
            for id in going {
                apart.departure[(id.0 - apart.first) as usize] = departed;
                departed += 1;
                for before in before(straight, id) {
                    let waits = &mut waiting[(before.0 - apart.first) as usize];
                    *waits -= 1;
                    if *waits == 0 {
                        ready.push(before);
                    }
                }
            }
        }
    }
}
