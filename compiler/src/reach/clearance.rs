//! Warns of access paths without clearance: gaps one block wide.
use std::collections::VecDeque;

use petgraph::Direction::Incoming;
use petgraph::graph::NodeIndex;
use petgraph::visit::EdgeRef;
use rustc_hash::{FxHashMap, FxHashSet};
use stochc_estimate::{beside_gap, gap_entrances};
use stochc_ir::Face;

use super::analysis::ReachAnalysis;
use super::descendants::{DescendantIndex, Descendants};
use super::graph_paths::before;
use super::moving_cube::MovingCube;
use super::path_search::SearchOutcome;
use crate::dependencies::graph::LocatedDependency;
use crate::expanded::EventId;
use crate::expanded::EventKind;
use stochc_ir::Cell;

/// A capture whose block must enter through a one-block gap.
pub struct NarrowCapture {
    pub capture: EventId,
    /// Number of narrow cells of the path with the fewest narrow cells. `None` if they are too many
    /// to count.
    pub length: Option<u32>,
    /// Captures in neighbouring cells that form the gap. If two of them are on opposite sides, the
    /// list contains only these two.
    pub walls: Vec<EventId>,
}

/// Captures of a phase whose blocks must enter through a one-block gap.
pub struct NarrowCaptures {
    pub count: usize,
    /// The tightest captures, the worst one first.
    pub worst: Vec<NarrowCapture>,
}

/// Largest number of captures of a phase that are described.
const MAX_SHOWN: usize = 5;

/// Largest number of cells visited to measure a gap. The length of a longer gap does not matter.
const FARTHEST: usize = 1_000;

impl ReachAnalysis<'_> {
    /// Returns the captures of a phase that enter through a gap if events happen in the worst order
    /// for the capture. In this order, everything that does not depend on the capture happens
    /// first.
    pub fn narrow(&mut self, events: &[EventId], descendants: &DescendantIndex) -> NarrowCaptures {
        let first = events.iter().map(|id| id.0).min().unwrap_or(0);
        // For each event, whether only its descendants can be above its cell.
        let mut is_clear_above = vec![false; events.len()];
        let mut found: Vec<(u32, EventId)> = Vec::new();
        for &id in events.iter().rev() {
            let (Some(cell), true) = (self.cell(id), self.is_capture(id)) else {
                continue;
            };
            let i = (id.0 - first) as usize;
            is_clear_above[i] |= self.occupancy.is_top(cell);
            if is_clear_above[i]
                && let Some(below) = self.captor_below(id, first)
                && !self.occupancy.is_retained(cell)
            {
                is_clear_above[below] = true;
            }
            if is_clear_above[i] && self.has_open_corner(cell) {
                continue;
            }
            if self.is_handed_over(id, descendants) {
                continue;
            }
            self.occupancy.sort();
            let Some(following) = descendants.within(id, &mut self.warning) else {
                break;
            };
            if let Some(open) = self.tightness(cell, self.path(id), &following) {
                found.push((open, id));
            }
        }
        let count = found.len();
        found.sort_unstable();
        found.truncate(MAX_SHOWN);
        let worst = (found.into_iter())
            .map(|(_, capture)| NarrowCapture {
                capture,
                length: self.gap_length(capture, descendants),
                walls: self.gap_walls(capture, descendants),
            })
            .collect();
        NarrowCaptures { count, worst }
    }

    /// Returns whether a capture takes over a block that is released in the same cell. The block
    /// stays in place and needs no access path.
    fn is_handed_over(&mut self, id: EventId, descendants: &DescendantIndex) -> bool {
        let graph = self.subject.graph;
        let mut edges = graph.edges_directed(NodeIndex::new(id.0 as usize), Incoming);
        let Some(vacated) = edges.find(|edge| *edge.weight() == LocatedDependency::Vacated) else {
            return false;
        };
        let release = graph[vacated.source()];
        let mut others = before(graph, id).filter(|&first| first != release);
        others.all(|first| {
            let following = descendants.within(first, &mut self.warning);
            following.is_some_and(|following| following.contains(release))
        })
    }

    /// Returns the capture of the same phase that attaches the capturing block. Returns `None` if
    /// the capture is not by the face `up`, or if there is no such capture.
    fn captor_below(&self, id: EventId, first: u32) -> Option<usize> {
        let EventKind::Capture { face: Face::Up, .. } = self.subject.plan.event(id).kind else {
            return None;
        };
        let anchored_by = self.subject.liveness.contexts[id.0 as usize].anchored_by?;
        Some((anchored_by.0 - first) as usize)
    }

    /// Returns whether three columns next to a cell are empty: two neighbouring sides and the
    /// corner between them.
    fn has_open_corner(&self, cell: Cell) -> bool {
        let is_clear = |dx: i32, dy: i32| {
            cell.offset([dx, dy, 0])
                .is_none_or(|cell| self.occupancy.is_clear(cell.x, cell.y, cell.z))
        };
        let corners = [(1, 1), (1, -1), (-1, 1), (-1, -1)];
        (corners.into_iter()).any(|(dx, dy)| is_clear(dx, 0) && is_clear(0, dy) && is_clear(dx, dy))
    }

    /// Returns the face of a capture if blocks can pass a gap along its direction in this scene.
    fn path(&self, id: EventId) -> Option<Face> {
        match self.subject.plan.event(id).kind {
            EventKind::Capture { face, .. } if self.subject.has_passable_gaps => Some(face),
            _ => None,
        }
    }

    /// Returns the number of open sides of a cell that only narrow paths reach. Returns `None` if
    /// the cell has a wide access path. A path is wide if a cube with an edge of two block lengths
    /// fits through. A wide path may end in a passable gap in the direction of the face `path`.
    fn tightness(
        &mut self,
        cell: Cell,
        path: Option<Face>,
        following: &Descendants<'_>,
    ) -> Option<u32> {
        let has = |other: EventId| !following.contains(other);
        let search = MovingCube {
            occupancy: &self.occupancy,
            has: &has,
            size: 2,
        };
        let is_empty = |cell: Cell| !self.occupancy.is_blocked(cell, &has);
        let is_gap = |path: &Face| beside_gap(cell, *path).all(is_empty);
        // Most cells are decided without testing gaps.
        for is_inside in [true, false] {
            let lows: Vec<Cell> = if is_inside {
                self.boxes(cell).collect()
            } else {
                (path.filter(is_gap).into_iter())
                    .flat_map(|path| gap_entrances(cell, path))
                    .collect()
            };
            let free = lows.into_iter().filter(|&low| !search.is_blocked(low));
            match search.find_path(
                free,
                &|_| false,
                &mut self.known_paths[1],
                &mut self.warning,
            ) {
                SearchOutcome::Out | SearchOutcome::Unknown => return None,
                SearchOutcome::Sealed(_) => {}
            }
        }
        let is_open = |face: &Face| {
            (cell.across(*face)).is_some_and(|next| !self.occupancy.is_blocked(next, &has))
        };
        Some(Face::ALL.iter().filter(|face| is_open(face)).count() as u32)
    }

    /// Returns the captures that form the gap of a capture, in the worst case of the phase.
    fn gap_walls(&mut self, id: EventId, descendants: &DescendantIndex) -> Vec<EventId> {
        let Some(cell) = self.cell(id) else {
            return Vec::new();
        };
        let following = descendants.of(id, &mut self.warning.steps);
        let docks_on = match self.subject.plan.event(id).kind {
            EventKind::Capture { face, .. } => Some(self.face_in_search(face.opposite())),
            EventKind::Release => None,
        };
        let has = |other: EventId| !following.contains(other);
        let wall = |face: Face| {
            let next = cell.across(face).filter(|_| Some(face) != docks_on)?;
            let is_blocked = self.occupancy.is_blocked(next, &has);
            self.occupancy.at(next).filter(|_| is_blocked)
        };
        let opposite = Face::ALL.into_iter().find_map(|face| {
            let (one, other) = (wall(face)?, wall(face.opposite())?);
            Some(vec![one.min(other), one.max(other)])
        });
        opposite.unwrap_or_else(|| {
            let mut walls: Vec<EventId> = Face::ALL.into_iter().filter_map(wall).collect();
            walls.sort_unstable();
            walls
        })
    }

    /// Returns the number of narrow cells of the path with the fewest narrow cells. Returns `None`
    /// if they are too many to count.
    fn gap_length(&mut self, id: EventId, descendants: &DescendantIndex) -> Option<u32> {
        let start = self.cell(id)?;
        let following = descendants.of(id, &mut self.warning.steps);
        let has = |other: EventId| !following.contains(other);
        let wide = MovingCube {
            occupancy: &self.occupancy,
            has: &has,
            size: 2,
        };
        // Finds the path with the fewest narrow cells. Wide cells cost nothing and go to the front
        // of the queue.
        let mut best: FxHashMap<Cell, u32> = FxHashMap::from_iter([(start, 1)]);
        let mut queue = VecDeque::from([start]);
        let mut closed: FxHashSet<Cell> = FxHashSet::default();
        while let Some(at) = queue.pop_front() {
            let length = best[&at];
            let free = self.boxes(at).find(|&low| !wide.is_blocked(low));
            if let Some(low) = free
                && !closed.contains(&low)
            {
                match wide.find_path(
                    [low],
                    &|_| false,
                    &mut self.known_paths[1],
                    &mut self.warning,
                ) {
                    SearchOutcome::Out => return Some(length),
                    SearchOutcome::Sealed(pocket) => closed.extend(pocket),
                    SearchOutcome::Unknown => return None,
                }
            }
            self.warning.steps += 1 + self.occupancy.take_passed();
            if best.len() > FARTHEST || self.warning.is_spent() {
                return None;
            }
            for face in Face::ALL {
                let Some(next) = at.across(face) else {
                    continue;
                };
                if self.occupancy.is_blocked(next, &has) {
                    continue;
                }
                let is_wide = self.boxes(next).any(|low| !wide.is_blocked(low));
                let length = length + u32::from(!is_wide);
                if best.get(&next).is_some_and(|&known| known <= length) {
                    continue;
                }
                best.insert(next, length);
                if is_wide {
                    queue.push_front(next);
                } else {
                    queue.push_back(next);
                }
            }
        }
        // All paths to the sky are narrow.
        None
    }

    /// Returns the cubes of two block lengths that contain a cell, above the ground.
    fn boxes(&self, cell: Cell) -> impl Iterator<Item = Cell> + use<> {
        let is_planar = self.subject.plane.is_some();
        (0..8).filter_map(move |i| {
            let low = cell.offset([0, 1, 2].map(|axis| -(i >> axis & 1)))?;
            (low.z >= 1 || is_planar).then_some(low)
        })
    }
}
