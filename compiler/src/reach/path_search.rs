//! Searches for a path from a position next to the structure to the open sky.
//!
//! A pocket can have many more cells than its walls. The search therefore follows the walls, and
//! leaves them only straight upwards. This is sufficient, for the following reason. Replace the
//! ground by the mirror image of the structure. The side of a wall that faces one region is then
//! connected, because a connected obstacle bounds each region of its complement in one piece. No
//! other wall divides it. The highest cell of an outer side sees the sky, or the next wall that
//! encloses it.
use std::collections::VecDeque;
use std::collections::hash_map::Entry;

use rustc_hash::FxHashMap;
use stochc_ir::{Cell, Face};

use super::effort::SearchEffort;
use super::known_paths::KnownPaths;
use super::moving_cube::MovingCube;
use crate::expanded::EventId;

pub enum SearchOutcome {
    /// There is a path.
    Out,
    /// No path exists. Contains the cells along the walls in the order of the search.
    Sealed(Vec<Cell>),
    /// The search reached its limit.
    Unknown,
}

impl MovingCube<'_> {
    /// Searches for a path of the cube from one of the free positions `starts` to the open sky. The
    /// search is breadth-first, so that recorded paths are short. `is_out` returns whether the cell
    /// of an event is known to have a path.
    pub fn find_path(
        &self,
        starts: impl IntoIterator<Item = Cell>,
        is_out: &dyn Fn(EventId) -> bool,
        known: &mut KnownPaths,
        effort: &mut SearchEffort<'_>,
    ) -> SearchOutcome {
        // Previous position of each reached position.
        let mut found: FxHashMap<Cell, Cell> = FxHashMap::default();
        let mut order = Vec::new();
        let mut queue = VecDeque::new();
        for start in starts {
            if found.insert(start, start).is_none() {
                queue.push_back(start);
            }
        }
        while let Some(at) = queue.pop_front() {
            order.push(at);
            effort.steps += 1 + self.occupancy.take_passed();
            if effort.is_spent() {
                return SearchOutcome::Unknown;
            }
            if self.size == 1 && self.occupancy.at(at).is_some_and(is_out) {
                return SearchOutcome::Out;
            }
            if known.leads_out(at, self, &mut effort.steps) {
                known.keep(at, &found, self);
                return SearchOutcome::Out;
            }
            let Some(under) = self.rise(at) else {
                known.end(at, self);
                known.keep(at, &found, self);
                return SearchOutcome::Out;
            };
            for face in Face::ALL {
                let Some(next) = at.across(face) else {
                    continue;
                };
                if !found.contains_key(&next) && !self.is_blocked(next) && self.is_at_wall(next) {
                    found.insert(next, at);
                    queue.push_back(next);
                }
            }
            if let Entry::Vacant(place) = found.entry(under) {
                place.insert(at);
                queue.push_front(under);
            }
        }
        SearchOutcome::Sealed(order)
    }
}
