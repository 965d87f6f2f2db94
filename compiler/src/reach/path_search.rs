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
use super::occupancy::{Has, OccupiedCells};
use crate::plan::EventId;

/// What a search looks at.
pub struct PathSearch<'a> {
    /// The structure, sorted.
    pub occupancy: &'a OccupiedCells,
    /// Which of its captures have happened.
    pub has: Has<'a>,
    /// Edge of the cube that has to get through, in cells: 1 or 2.
    pub size: i32,
}

/// How a search ended.
pub enum SearchOutcome {
    /// There is one.
    Out,
    /// There is none; the cells along the walls, in the order in which they were found.
    Sealed(Vec<Cell>),
    /// The search was given up.
    Unknown,
}

impl PathSearch<'_> {
    /// Whether a cube with its low corner at `at` meets a blocked cell.
    pub fn is_blocked(&self, at: Cell) -> bool {
        self.meets(at, 0, self.size)
    }

    /// Whether one of the cells of a cube from `low` to below `high`, seen from `at`, is blocked.
    fn meets(&self, at: Cell, low: i32, high: i32) -> bool {
        let range = || low..high;
        range().any(|dz| {
            range().any(|dy| {
                range().any(|dx| match offset(at, dx, dy, dz) {
                    Some(cell) => self.occupancy.is_blocked(cell, self.has),
                    None => true,
                })
            })
        })
    }

    /// Whether a cube could touch something with an edge or a corner, the ground apart.
    pub fn is_at_wall(&self, at: Cell) -> bool {
        (-1..=self.size).any(|dz| {
            (-1..=self.size).any(|dy| {
                (-1..=self.size).any(|dx| {
                    offset(at, dx, dy, dz).is_some_and(|cell| {
                        cell.z >= 1 && self.occupancy.is_blocked(cell, self.has)
                    })
                })
            })
        })
    }

    /// The height of what stops a cube on its way up; `None`: nothing.
    fn ceiling(&self, at: Cell) -> Option<i32> {
        let columns = (0..self.size).flat_map(|dx| (0..self.size).map(move |dy| (dx, dy)));
        columns
            .filter_map(|(dx, dy)| {
                let column = offset(at, dx, dy, 0)?;
                (self.occupancy).ceiling(column.x, column.y, column.z, self.has)
            })
            .min()
    }

    /// The place under what stops a free cube on its way up; `None`: nothing does.
    pub fn rise(&self, at: Cell) -> Option<Cell> {
        let z = self.ceiling(at)? - self.size;
        Some(Cell { z, ..at })
    }

    /// Whether nothing stops a cube that is free at `at` on its way up to `z`.
    pub fn rises_to(&self, at: Cell, z: i32) -> bool {
        self.rise(at).is_none_or(|under| under.z >= z)
    }

    /// Whether a cube that is free at `at` can rise to the sky.
    pub fn sees_sky(&self, at: Cell) -> bool {
        self.ceiling(at).is_none()
    }

    /// Searches from places that are free, the nearest first, so that the ways that are kept are short;
    /// `is_out` knows of events whose cell has a way out.
    pub fn run(
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

/// A cell some steps away; `None` where a coordinate would overflow.
pub fn offset(cell: Cell, dx: i32, dy: i32, dz: i32) -> Option<Cell> {
    Some(Cell {
        x: cell.x.checked_add(dx)?,
        y: cell.y.checked_add(dy)?,
        z: cell.z.checked_add(dz)?,
    })
}
