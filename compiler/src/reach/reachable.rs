//! What some order reaches, and an order that does.
use rustc_hash::FxHashSet;

use super::descendants::DescendantIndex;
use super::moving_cube::MovingCube;
use super::occupancy::Has;
use super::path_search::SearchOutcome;
use super::{EventId, ReachAnalysis, after, all_before, before};
use crate::face_turns::is_ready;
use crate::graph::DependencyGraph;

/// How a phase is taken apart again, the last block first.
///
/// Nothing is released in it, so that taking a block away only opens ways: what may go now may go
/// later too, and it does not matter what goes first. Whatever stays keeps what it waits for.
pub struct Dismantled {
    first: u32,
    /// For every event of the phase, how many have gone before it.
    gone_at: Vec<u32>,
    /// Whether all that was asked for has gone. If so, the reverse is an order that reaches all of it.
    pub is_whole: bool,
}

/// Has not gone.
const STAYS: u32 = u32::MAX;

impl Dismantled {
    /// How many have gone before this event of the phase; `u32::MAX`: it stays.
    pub fn gone_at(&self, id: EventId) -> u32 {
        self.gone_at[(id.0 - self.first) as usize]
    }

    /// Whether an event of the phase has gone.
    pub fn has_gone(&self, id: EventId) -> bool {
        self.gone_at(id) != STAYS
    }
}

impl ReachAnalysis<'_> {
    /// The way out of the cell of a capture.
    pub fn way_out(&mut self, id: EventId, has: Has) -> SearchOutcome {
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

    /// Events of a phase that no order reaches: captures that are closed in by what they wait for, and all
    /// that waits for such a one.
    ///
    /// None of them ever happens: the first to happen in some run would have waited for others alone, with at
    /// least the captures around it that it surely waits for, and every release so far has been counted on.
    pub fn never(
        &mut self,
        events: &[EventId],
        descendants: &DescendantIndex,
    ) -> FxHashSet<EventId> {
        let has_releases = events.iter().any(|&id| !self.is_capture(id));
        let kept = has_releases.then(|| {
            (
                self.occupancy.clone(),
                std::mem::take(&mut self.known_paths),
            )
        });
        let mut never: FxHashSet<EventId> = events.iter().copied().collect();
        loop {
            let (mut opens_ways, mut has_more) = (false, false);
            for &id in events {
                let is_reached = |first: EventId| !never.contains(&first);
                if is_reached(id) || !is_ready(self.subject.graph, id, is_reached) {
                    continue;
                }
                let is_capture = self.is_capture(id);
                let is_closed = is_capture
                    && !self.is_safe[id.0 as usize]
                    && matches!(
                        self.way_past_its_own(id, descendants),
                        SearchOutcome::Sealed(_)
                    );
                if is_closed {
                    continue;
                }
                never.remove(&id);
                has_more = true;
                if !is_capture {
                    self.depart(id);
                    opens_ways = true;
                }
            }
            // Of a choice, what comes later in this order may be enough.
            let is_over = !has_more || !(opens_ways || self.has_choice());
            if is_over {
                break;
            }
        }
        if let Some((occupancy, known_paths)) = kept {
            self.occupancy = occupancy;
            self.known_paths = known_paths;
        }
        never
    }

    /// The way out of a cell when of the phase only what the capture surely waits for has happened.
    pub fn way_past_its_own(
        &mut self,
        id: EventId,
        descendants: &DescendantIndex,
    ) -> SearchOutcome {
        if self.remedies.is_spent() {
            return SearchOutcome::Unknown;
        }
        let own = all_before(self.subject.certain, [id]);
        self.remedies.steps += own.len() as u64;
        self.way_out(id, &|other| {
            !descendants.has(other) || (other != id && own.contains(&other))
        })
    }

    /// Takes events of a phase without releases apart that hold with each of them all that it waits for, in a graph
    /// where every choice has been made; `None`: that was given up.
    ///
    /// The reverse is an order of the program. If something stays, and there was a choice, another one may do better.
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
            gone_at: vec![STAYS; events.len()],
            is_whole: false,
        };
        let local = |id: EventId| (id.0 - apart.first) as usize;
        // How many have to go first.
        let mut waiting = vec![0u32; events.len()];
        for &id in &members {
            waiting[local(id)] = after(straight, id).filter(|&next| is_member(next)).count() as u32;
        }
        let mut ready: Vec<EventId> = (members.iter().copied())
            .filter(|&id| waiting[local(id)] == 0)
            .collect();
        let mut closed: Vec<EventId> = Vec::new();
        let mut gone = 0;
        loop {
            let mut going = Vec::new();
            closed.append(&mut ready);
            closed.sort_unstable();
            // First all that can go without asking.
            for id in std::mem::take(&mut closed) {
                if self.is_safe[id.0 as usize] {
                    going.push(id);
                } else {
                    closed.push(id);
                }
            }
            if going.is_empty() {
                for id in std::mem::take(&mut closed) {
                    let way = self.way_out(id, &|other| {
                        !descendants.has(other)
                            || (other != id && is_member(other) && !apart.has_gone(other))
                    });
                    match way {
                        SearchOutcome::Out => going.push(id),
                        SearchOutcome::Sealed(_) => closed.push(id),
                        SearchOutcome::Unknown => return None,
                    }
                }
            }
            if going.is_empty() {
                apart.is_whole = members.len() == gone as usize;
                return Some(apart);
            }
            for id in going {
                apart.gone_at[(id.0 - apart.first) as usize] = gone;
                gone += 1;
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
