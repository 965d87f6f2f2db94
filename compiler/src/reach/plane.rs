//! The plane of a planar world in the frame of the search.
//!
//! The frame is turned so that free blocks come from above, as in space. If they come from the
//! north, cell (x, y, 1) is stored as (x, 0, y). Cells outside the walls are blocked.
use stochc_ir::scene::{Planar, PlanarAccess, PlanarArea, Scene};
use stochc_ir::{Cell, Face};

use crate::expanded::ExpandedProgram;
use crate::shapes::layout::Layout;

/// Plane with its walls.
#[derive(Clone, Copy, Debug)]
pub struct Plane(PlanarAccess);

impl Plane {
    /// Returns the plane of a program. Returns `None` if the world is not planar.
    pub fn new(scene: &Scene, plan: &ExpandedProgram, layout: &Layout) -> Option<Plane> {
        let area = PlanarArea::from_scene(scene, &plan.plate)?;
        let seeds = plan.seeds.iter().map(|seed| seed.cell);
        let cells = seeds.chain(layout.cells.iter().flatten().copied());
        Some(Plane(area.access(&cells.collect::<Vec<_>>())))
    }

    /// Returns whether the search ignores walls, because no side has enough room.
    pub fn ignores_walls(&self) -> bool {
        self.0.ignores_walls
    }

    /// Returns a cell in the frame of the search.
    pub(super) fn turn(&self, cell: Cell) -> Cell {
        let [x, y, _] = self.0.side.normal();
        let height = x * cell.x + y * cell.y;
        let across = if x == 0 { cell.x } else { cell.y };
        Cell::new(across, cell.z - Planar::LAYER, height)
    }

    /// Returns a cell of the search in the frame of the structure.
    fn turn_back(&self, Cell { x: across, y, z }: Cell) -> Cell {
        let layer = y + Planar::LAYER;
        match self.0.side.normal() {
            [0, sign, _] => Cell::new(across, sign * z, layer),
            [sign, ..] => Cell::new(sign * z, across, layer),
        }
    }

    /// Returns a face in the frame of the search.
    pub(super) fn turn_face(&self, face: Face) -> Face {
        let origin = self.turn(Cell::new(0, 0, 0));
        let turned = Cell::new(0, 0, 0).across(face).map(|next| self.turn(next));
        let mut faces = Face::ALL.into_iter();
        let found = faces.find(|face| origin.across(*face) == turned);
        found.unwrap_or(face)
    }

    /// Returns whether walls block cells.
    pub(super) fn has_walls(&self) -> bool {
        self.0.area.has_walls()
    }

    /// Returns whether the walls or the end of the plane block a cell of the search.
    pub(super) fn is_wall(&self, cell: Cell) -> bool {
        cell.y != 0 || !self.0.area.contains(self.turn_back(cell))
    }

    /// Returns the height of the wall above a cell of the search. Returns `None` if no wall is
    /// between this cell and the rows beyond the structure.
    pub(super) fn wall_above(&self, cell: Cell) -> Option<i32> {
        let [x, y, _] = self.0.side.normal();
        let row = (x + y) * self.0.row;
        let open = Cell {
            z: row.max(cell.z),
            ..cell
        };
        if !self.is_wall(cell) && !self.is_wall(open) {
            return None;
        }
        (cell.z..=open.z).find(|&z| self.is_wall(Cell { z, ..cell }))
    }
}
