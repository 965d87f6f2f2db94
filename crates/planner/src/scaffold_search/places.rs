//! Positions for masts, and possible segments on them.
use rustc_hash::FxHashMap;
use stochc_ir::{Cell, Face};

use super::trial::NoScaffolds;
use crate::Target;
use crate::scaffold::{MastSegment, Scaffolding, SiteRoles};
use crate::scheduling::WAIT;
use crate::space::sites::{NONE, Sites};
use crate::timing::schedule::Schedule;

/// Final parent and capture time of each cell of the target.
pub struct GrowthSchedule {
    /// Final parent of each cell (`None` for a block of the plate), and the mean tick of its
    /// capture.
    cells: FxHashMap<Cell, (Option<Cell>, f32)>,
}

/// Time that is later than all captures \[waiting times\].
const LATE: f32 = 10_000.0;

/// Largest number of cells of a segment.
const LONGEST: usize = 60;

/// Checks that the plate has space for a mast next to or under a target.
///
/// # Errors
///
/// If it has none.
pub fn has_place(target: &Target) -> Result<(), NoScaffolds> {
    if !target.existing().is_empty() {
        return Err(NoScaffolds::BlocksStand);
    }
    let mut cells = target.cells().iter().flat_map(|&cell| {
        let foot = Cell::new(cell.x, cell.y, 1);
        Face::SIDES
            .into_iter()
            .filter_map(move |face| foot.across(face))
            .chain([foot])
    });
    let is_full = |cell: &Cell| target.cells().binary_search(cell).is_ok();
    if cells.any(|foot| target.is_on_seed(foot) && !is_full(&foot)) {
        return Ok(());
    }
    Err(NoScaffolds::NoPlace)
}

impl GrowthSchedule {
    pub fn new(
        sites: &Sites<'_>,
        schedule: &Schedule,
        scaffolding: &Scaffolding,
    ) -> GrowthSchedule {
        let segments = scaffolding.segments.iter();
        let in_the_end: FxHashMap<Cell, Face> =
            segments.flat_map(MastSegment::handed_over).collect();
        let cells = schedule.order.iter().map(|&site| {
            let cell = sites.cell(site);
            let direction = in_the_end.get(&cell).copied();
            let direction = direction.unwrap_or(schedule.direction[site as usize]);
            let holder = cell
                .across(direction.opposite())
                .filter(|holder| holder.z > 0);
            (cell, (holder, schedule.end[site as usize]))
        });
        GrowthSchedule {
            cells: cells.collect(),
        }
    }

    /// Returns the parent of each site at its capture, [`NONE`] for the plate.
    pub fn holders(&self, sites: &Sites<'_>, roles: &SiteRoles) -> Vec<u32> {
        let holder = |site: u32| match roles.direction(site) {
            Some(direction) => sites.next(site, direction.opposite()),
            None => {
                let holder = self
                    .cells
                    .get(&sites.cell(site))
                    .and_then(|&(holder, _)| holder);
                holder.map_or(NONE, |holder| sites.at(holder))
            }
        };
        (0..sites.len() as u32).map(holder).collect()
    }

    /// Returns approximate capture times for equal waiting times. Cells attached to segments come
    /// after all others.
    pub fn times(&self, sites: &Sites<'_>, scaffolding: &Scaffolding) -> Vec<f32> {
        let mut on_mast: FxHashMap<Cell, f32> = FxHashMap::default();
        for segment in &scaffolding.segments {
            let times = segment.cells.iter().zip(1..);
            on_mast.extend(times.map(|(&cell, i)| (cell, (segment.height + i) as f32)));
        }
        let time = |site: u32| {
            let cell = sites.cell(site);
            let Some(&(mut holder, end)) = self.cells.get(&cell) else {
                // A cell of a mast.
                return cell.z as f32;
            };
            if let Some(&time) = on_mast.get(&cell) {
                return time;
            }
            let mut late = 0.0;
            while let Some(at) = holder {
                late = if on_mast.contains_key(&at) {
                    LATE
                } else {
                    late
                };
                holder = self.cells.get(&at).and_then(|&(holder, _)| holder);
            }
            end / WAIT + late
        };
        (0..sites.len() as u32).map(time).collect()
    }

    /// Returns the cells of the target, each with the number of captures from the plate to it. The
    /// largest number comes first.
    pub fn far_first(&self) -> Vec<(Cell, usize)> {
        let cells = self.cells.keys();
        let mut cells: Vec<(Cell, usize)> = cells.map(|&cell| (cell, self.depth(cell))).collect();
        cells.sort_unstable_by_key(|&(cell, depth)| (std::cmp::Reverse(depth), cell));
        cells
    }

    /// Returns the final parent of a cell, or `None` for a block of the plate.
    pub fn holder(&self, cell: Cell) -> Option<Cell> {
        self.cells.get(&cell).and_then(|&(holder, _)| holder)
    }

    /// Returns the number of captures from the plate to a cell, including its own.
    pub fn depth(&self, cell: Cell) -> usize {
        std::iter::successors(Some(cell), |&cell| self.holder(cell)).count()
    }

    /// Returns scaffolds with one more segment, one for each segment length that saves captures.
    /// The mast block at `at` captures the cell `first` of the new segment.
    ///
    /// If `first` is within another segment, the new segment takes over the end of that segment.
    pub fn extensions(
        &self,
        at: Cell,
        direction: Face,
        first: Cell,
        scaffolding: &Scaffolding,
    ) -> Vec<Scaffolding> {
        let mut found = Vec::new();
        let mut rest = scaffolding.clone();
        let mut least = 1;
        let within = |segment: &MastSegment| segment.cells.iter().position(|&cell| cell == first);
        for segment in &mut rest.segments {
            match within(segment) {
                None => {}
                // There is already a mast.
                Some(0) => return found,
                Some(place) => {
                    least = segment.cells.len() - place;
                    segment.cells.truncate(place);
                    segment.join = first;
                }
            }
        }
        let mut cells = Vec::new();
        let mut next = Some(first);
        while let Some(cell) = next {
            cells.push(cell);
            let is_held = rest
                .segments
                .iter()
                .any(|segment| segment.cells.contains(&cell));
            let Some(join) = self.holder(cell) else {
                return found;
            };
            // Number of consecutive captures through the mast.
            let captures = at.z as usize + cells.len();
            if is_held || cells.len() > LONGEST || captures >= self.depth(cell) {
                return found;
            }
            if cells.len() >= least {
                let mut scaffolding = rest.clone();
                scaffolding.segments.push(MastSegment {
                    foot: (at.x, at.y),
                    height: at.z,
                    direction,
                    cells: cells.clone(),
                    join,
                });
                found.push(scaffolding);
            }
            next = Some(join);
        }
        found
    }
}

/// Returns the mast blocks that could hold a cell, each with the direction from the mast block to
/// the cell.
pub fn supports(target: &Target, cell: Cell) -> impl Iterator<Item = (Cell, Face)> {
    let is_full = |cell: Cell| target.cells().binary_search(&cell).is_ok();
    let is_place = move |&(at, _): &(Cell, Face)| {
        target.is_on_seed(Cell::new(at.x, at.y, 1))
            && (1..=at.z).all(|z| !is_full(Cell::new(at.x, at.y, z)))
            && at.z >= 1
    };
    let directions = Face::SIDES.into_iter().chain([Face::Up]);
    let beside = directions
        .filter_map(move |direction| Some((cell.across(direction.opposite())?, direction)));
    beside.filter(is_place)
}
