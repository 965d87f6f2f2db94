//! Free positions of a cube that are reachable from outside.
use rustc_hash::FxHashMap;
use stochc_estimate::{beside_gap, gap_entrances};
use stochc_ir::scene::{Planar, PlanarAccess};
use stochc_ir::{Cell, Face};

use crate::space::grid::{Grid, shifted};
use crate::space::sites::{NONE, Sites};

/// Positions that a cube can reach from outside. Each position is given by the low corner of the
/// cube.
#[derive(Clone, Debug)]
pub struct FreeSpace {
    /// Edge length of the cube \[cells\].
    size: i32,
    /// Whether a cube at a reachable position can also bring a block into adjacent gaps.
    has_gaps: bool,
    /// Area of a planar world, where the cube is a square that stays inside.
    plane: Option<PlanarAccess>,
    reach: Grid<PlaceReach>,
    /// For each position above a gap in a sparse grid, the position below the gap. Nothing is in
    /// the gap. In a planar world, up is towards the side that free blocks come from.
    across_gap: FxHashMap<Cell, Cell>,
}

/// Access of a cube to a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AccessPath {
    /// The cube covers the cell.
    Inside,
    /// The block slides from the cube into a gap. A face along this axis must capture it.
    Gap(Face),
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum PlaceReach {
    /// Not reachable so far.
    #[default]
    Closed,
    /// Reachable after parts of the target were removed.
    Opened,
    /// Reachable with the complete target.
    Always,
}

impl FreeSpace {
    /// Returns the positions that a cube with edges of `size` cells can reach if the target is
    /// complete.
    pub fn new(sites: &Sites<'_>, size: i32) -> FreeSpace {
        let cells = sites.target.cells();
        let plane = sites.target.plane().copied();
        let entrance = plane.map(|plane| plane.entrance());
        let enclosed: Vec<Cell> = cells.iter().copied().chain(entrance).collect();
        let mut space = FreeSpace {
            size,
            has_gaps: false,
            plane,
            reach: Grid::around(&enclosed, 3),
            across_gap: FxHashMap::default(),
        };
        let mut open = Vec::new();
        if let Some(plane) = &plane {
            let tops = space.find_gaps(plane.side);
            let open = space.beside_structure(sites, plane, &tops);
            space.flood(sites, open, &|_| true, PlaceReach::Always, &mut |_| {});
            return space;
        }
        space.find_gaps(Face::Up);
        // Sorted by x, y, z: the last cell of each column is its highest.
        for (i, &cell) in cells.iter().enumerate() {
            let is_top = cells
                .get(i + 1)
                .is_none_or(|next| (next.x, next.y) != (cell.x, cell.y));
            if is_top {
                // Positions outside, above and next to all nearby cells. The highest cell of a
                // neighbourhood has free space above.
                open.extend(space.beside_top(sites, cell));
            }
        }
        space.flood(sites, open, &|_| true, PlaceReach::Always, &mut |_| {});
        space
    }

    /// Sets whether gaps are accessible as well. In a planar world, they never are.
    #[must_use]
    pub fn with_gaps(self, has_gaps: bool) -> FreeSpace {
        let has_gaps = has_gaps && self.plane.is_none();
        FreeSpace { has_gaps, ..self }
    }

    /// Finds the gaps of each column of a sparse grid. Returns the highest position of each column.
    /// Nothing is above it.
    fn find_gaps(&mut self, up: Face) -> Vec<Cell> {
        let [x, y, z] = up.normal();
        let height = |cell: &Cell| x * cell.x + y * cell.y + z * cell.z;
        let column = |cell: &Cell| {
            let [x, y, z] = [x, y, z].map(|along| 1 - along.abs());
            Cell::new(x * cell.x, y * cell.y, z * cell.z)
        };
        let mut stored = self.reach.stored();
        stored.sort_unstable_by_key(|cell| (column(cell), height(cell)));
        let mut tops = Vec::new();
        for (i, &low) in stored.iter().enumerate() {
            let next = stored.get(i + 1);
            match next.filter(|next| column(next) == column(&low)) {
                None => tops.push(low),
                Some(next) if height(next) > height(&low) + 1 => {
                    self.across_gap.insert(*next, low);
                }
                Some(_) => {}
            }
        }
        tops
    }

    /// Returns the positions in the first rows beyond the structure of a planar world, and those of
    /// `tops` with nothing between them and these rows.
    fn beside_structure(
        &self,
        sites: &Sites<'_>,
        plane: &PlanarAccess,
        tops: &[Cell],
    ) -> Vec<Cell> {
        let [x, y, _] = plane.side.normal();
        let row = if x + y > 0 {
            plane.row
        } else {
            plane.row + 1 - self.size
        };
        let in_row = |cell: Cell| {
            if x == 0 {
                Cell::new(cell.x, row, cell.z)
            } else {
                Cell::new(row, cell.y, cell.z)
            }
        };
        let is_free = |low: &Cell| self.is_free(sites, *low, &|_| true);
        let cells = sites.target.cells().iter().copied();
        let rows = cells.chain([plane.entrance()]).map(in_row);
        let tops = (tops.iter().copied()).filter(|&top| is_free(&in_row(top)));
        rows.chain(tops).filter(is_free).collect()
    }

    /// Returns the positions of the cube that cover the cell above `top` and have no block above
    /// them.
    fn beside_top(&self, sites: &Sites<'_>, top: Cell) -> Vec<Cell> {
        let size = self.size;
        let lows = (0..size).flat_map(|dy| (0..size).map(move |dx| shifted(top, -dx, -dy, 1)));
        let cells = sites.target.cells();
        let sees_sky = |low: &Cell| {
            (0..size).all(|dy| {
                (0..size).all(|dx| {
                    let (x, y) = (low.x + dx, low.y + dy);
                    let behind = cells.partition_point(|cell| (cell.x, cell.y) <= (x, y));
                    let highest = cells[..behind].last();
                    highest.is_none_or(|at| (at.x, at.y) != (x, y) || at.z < low.z)
                })
            })
        };
        lows.filter(sees_sky).collect()
    }

    /// Marks the positions in `open`, and all free positions connected to them, as reachable. Calls
    /// `reached` with each new one.
    fn flood(
        &mut self,
        sites: &Sites<'_>,
        mut open: Vec<Cell>,
        stands: &impl Fn(u32) -> bool,
        reach: PlaceReach,
        reached: &mut impl FnMut(Cell),
    ) {
        open.retain(|&low| self.enter(low, reach));
        while let Some(low) = open.pop() {
            reached(low);
            let beside = Face::ALL.into_iter().filter_map(|face| low.across(face));
            for next in beside.chain(self.across_gap.get(&low).copied()) {
                if self.reach.get(next) == Some(PlaceReach::Closed)
                    && self.is_free(sites, next, stands)
                    && self.enter(next, reach)
                {
                    open.push(next);
                }
            }
        }
    }

    fn enter(&mut self, low: Cell, reach: PlaceReach) -> bool {
        let is_new = self.reach.get(low) == Some(PlaceReach::Closed);
        if is_new {
            self.reach.set(low, reach);
        }
        is_new
    }

    /// Returns the cells of the cube whose low corner is `low`.
    pub fn cells(&self, low: Cell) -> impl Iterator<Item = Cell> + use<> {
        let count = self.size * self.size * self.size;
        let size = self.size;
        (0..count).map(move |i| shifted(low, i % size, i / size % size, i / (size * size)))
    }

    /// Returns the positions of the cube that cover a cell. The whole cube is above the ground.
    pub fn around(&self, cell: Cell) -> impl Iterator<Item = Cell> + use<> {
        let lows = self.cells(cell).map(move |high| {
            Cell::new(
                2 * cell.x - high.x,
                2 * cell.y - high.y,
                2 * cell.z - high.z,
            )
        });
        lows.filter(|low| low.z >= 1)
    }

    /// Returns whether a cube above the ground, or a square inside the walls, fits at a position.
    pub fn is_free(&self, sites: &Sites<'_>, low: Cell, stands: &impl Fn(u32) -> bool) -> bool {
        let is_inside = match &self.plane {
            Some(plane) => {
                low.z == Planar::LAYER && self.cells(low).all(|cell| plane.area.contains(cell))
            }
            None => low.z >= 1,
        };
        is_inside && self.cells(low).all(|cell| is_empty(sites, cell, stands))
    }

    /// Returns whether a position is reachable with the complete target.
    pub fn is_always_open(&self, low: Cell) -> bool {
        self.reach.get(low) == Some(PlaceReach::Always)
    }

    /// Returns the access to the cell of a standing site, as if its block had been removed.
    pub fn access_path(
        &self,
        sites: &Sites<'_>,
        site: u32,
        stands: &impl Fn(u32) -> bool,
    ) -> Option<AccessPath> {
        let others = |other: u32| other != site && stands(other);
        let mut inside = self.around(sites.cell(site));
        if inside.any(|low| self.is_free(sites, low, &others) && self.is_reached(low)) {
            return Some(AccessPath::Inside);
        }
        let axes = [Face::East, Face::North, Face::Up].into_iter();
        let mut axes =
            axes.filter(|axis| self.has_gaps && sites.is_held_along(site, *axis, stands));
        let gap = axes.find(|&axis| {
            let cell = sites.cell(site);
            beside_gap(cell, axis).all(|beside| is_empty(sites, beside, stands))
                && gap_entrances(cell, axis)
                    .any(|low| self.is_open(low) && self.is_free(sites, low, stands))
        });
        gap.map(AccessPath::Gap)
    }

    fn is_reached(&self, low: Cell) -> bool {
        let mut beside = Face::ALL.into_iter().filter_map(|face| low.across(face));
        self.is_open(low) || beside.any(|low| self.is_open(low))
    }

    fn is_open(&self, low: Cell) -> bool {
        let reach = self.reach.get(low);
        reach.is_some_and(|reach| reach != PlaceReach::Closed)
    }

    /// Updates the space after the removal of a block. Calls `reached` with each position that
    /// becomes reachable.
    pub fn open(
        &mut self,
        sites: &Sites<'_>,
        removed: u32,
        stands: &impl Fn(u32) -> bool,
        reached: &mut impl FnMut(Cell),
    ) {
        let around = self.around(sites.cell(removed));
        let open: Vec<Cell> = around
            .filter(|&low| self.is_free(sites, low, stands) && self.is_reached(low))
            .collect();
        self.flood(sites, open, stands, PlaceReach::Opened, reached);
    }

    /// Returns the sites whose access can change if a position becomes reachable.
    pub fn concerned(&self, sites: &Sites<'_>, low: Cell) -> impl Iterator<Item = u32> {
        let size = self.size;
        let edge = size + 2;
        let cells = (0..edge * edge * edge).map(move |i| {
            shifted(
                low,
                i % edge - 1,
                i / edge % edge - 1,
                i / (edge * edge) - 1,
            )
        });
        cells
            .map(|cell| sites.at(cell))
            .filter(|&site| site != NONE)
    }
}

fn is_empty(sites: &Sites<'_>, cell: Cell, stands: &impl Fn(u32) -> bool) -> bool {
    let site = sites.at(cell);
    site == NONE || !stands(site)
}

#[cfg(test)]
mod tests {
    use stochc_compiler::scene::built_in;
    use stochc_ir::table::Plate;

    use super::*;
    use crate::Target;

    /// Returns whether a block can reach a cell of a complete target with a sparse grid.
    fn is_reachable(target: &Target, cell: Cell) -> bool {
        let sites = Sites::new(target);
        let space = FreeSpace::new(&sites, 1);
        assert!(!space.reach.stored().is_empty());
        let site = sites.at(cell);
        space.access_path(&sites, site, &|_| true).is_some()
    }

    /// A beam is far above a block of the plate, and no other block is near this block.
    #[test]
    fn a_block_far_below_a_beam_is_reachable() {
        let (height, length) = (91, 300);
        let under = Cell::new(length, 0, 1);
        let mut cells = vec![under];
        cells.extend((1..=height).map(|z| Cell::new(0, 0, z)));
        cells.extend((1..=length).map(|x| Cell::new(x, 0, height)));
        cells.extend((1..150).map(|y| Cell::new(0, y, 1)));
        let closed = Cell::new(length / 2, 75, 1);
        cells.push(closed);
        let beside = Face::ALL.into_iter().filter_map(|face| closed.across(face));
        cells.extend(beside.filter(|cell| cell.z > 0));
        let plate = Plate {
            width: 301,
            depth: 150,
        };
        let target = Target::new(cells, plate, None, 1000).unwrap();
        assert!(is_reachable(&target, under));
        assert!(!is_reachable(&target, closed));
    }

    /// Only one of two distant parts is next to the rows that free blocks come from.
    #[test]
    fn distant_parts_of_a_plane_are_reachable() {
        let mut scene = built_in("hemisphere").unwrap();
        scene.planar = Some(Planar { friction: None });
        scene.enclosure = None;
        let last = 1499;
        let plate = Plate {
            width: 1500,
            depth: 1500,
        };
        let cells = [Cell::new(1, 0, 1), Cell::new(last - 1, last, 1)];
        let seeds = Some(vec![(0, 0), (last, last)]);
        let target = Target::in_plane(cells.to_vec(), &scene, plate, seeds, 60).unwrap();
        assert!(cells.iter().all(|&cell| is_reachable(&target, cell)));
    }
}
