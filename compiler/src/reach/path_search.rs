//! Looks for a way from a place next to the structure to the open sky.
//!
//! A pocket can hold many more cells than its walls have, so the search keeps to the cells along
//! the walls, and leaves them only straight upwards. That is enough. Where the ground is replaced
//! by the mirror image of all that stands on it, the part of a wall's outer or inner skin that
//! faces one region is connected in itself (a connected obstacle bounds each region of its
//! complement in one piece), no other wall cuts it, and the highest cell of an outer skin sees the
//! sky or the next wall that encloses it.
use std::collections::VecDeque;
use std::collections::hash_map::Entry;

use rustc_hash::FxHashMap;
use stochc_ir::{Cell, Face};

use super::SearchEffort;
use super::known_paths::KnownPaths;
use super::moving_cube::MovingCube;
use crate::plan::EventId;

/// How a search ended.
pub enum SearchOutcome {
    /// There is one.
    Out,
    /// There is none; the cells along the walls, in the order in which they were found.
    Sealed(Vec<Cell>),
    /// The search was given up.
    Unknown,
}

impl MovingCube<'_> {
    /// Searches from places that are free, the nearest first, so that the ways that are kept are short;
    /// `is_out` knows of events whose cell has a way out.
    pub fn find_path(
        &self,
        starts: impl IntoIterator<Item = Cell>,
        is_out: &dyn Fn(EventId) -> bool,
        known: &mut KnownPaths,
        effort: &mut SearchEffort<'_>,
    ) -> SearchOutcome {
        // Where each place was reached from.
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
