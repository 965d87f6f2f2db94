//! Cells inside the walls of a planar world.
use super::{Enclosure, Planar, Scene};
use crate::table::plate::Plate;
use crate::{Cell, Face};

/// Tolerance for rounding errors, as in [`Extent::is_outside`](super::Extent::is_outside).
const ROUNDING: f64 = 1.0 + 1e-12;

/// Width of a passage along the structure \[cells\].
const PASSAGE: i32 = 2;

/// Area of a planar world, with the side of a structure that free blocks come from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarAccess {
    /// Area that free blocks move in.
    pub area: PlanarArea,
    /// Side of the structure.
    pub side: Face,
    /// First row beyond the structure on this side, as a coordinate along the side's axis.
    pub row: i32,
    /// Whether the area has walls that are ignored, because no side has enough room.
    pub ignores_walls: bool,
}

/// Area inside the walls of a planar world, in block lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarArea {
    /// Centre of the plate, where cells have their centres at whole numbers.
    middle: [f64; 2],
    /// Distance of the walls from the centre along x and y. Infinite for a disc.
    half: [f64; 2],
    /// Distance of a circular wall from the centre. Infinite for a rectangle.
    radius: f64,
}

impl PlanarAccess {
    /// Returns the middle of the first row beyond the structure.
    pub fn entrance(&self) -> Cell {
        self.area.middle_of_row(self.side, self.row, 0)
    }
}

impl PlanarArea {
    /// Returns the area of a scene. Returns `None` if the world is not planar.
    pub fn from_scene(scene: &Scene, plate: &Plate) -> Option<PlanarArea> {
        scene.planar.as_ref()?;
        let side = scene.block.side;
        let (half, radius) = match scene.enclosure {
            Some(Enclosure::Disc { radius, .. }) => ([f64::INFINITY; 2], radius / side),
            Some(Enclosure::Rectangle { length, width, .. }) => (
                [length, width].map(|across| across / 2.0 / side),
                f64::INFINITY,
            ),
            _ => ([f64::INFINITY; 2], f64::INFINITY),
        };
        let middle = [plate.width, plate.depth].map(|edge| (f64::from(edge) - 1.0) / 2.0);
        Some(PlanarArea {
            middle,
            half,
            radius,
        })
    }

    /// Returns whether a whole cell is inside.
    pub fn contains(&self, cell: Cell) -> bool {
        let far = [(cell.x, 0), (cell.y, 1)]
            .map(|(at, axis)| (f64::from(at) - self.middle[axis]).abs() + 0.5);
        let [x, y] = far;
        x <= self.half[0] * ROUNDING
            && y <= self.half[1] * ROUNDING
            && (x * x + y * y).sqrt() <= self.radius * ROUNDING
    }

    /// Returns whether the area has walls.
    pub fn has_walls(&self) -> bool {
        self.half[0].min(self.radius).is_finite()
    }

    /// Returns the middle of a row beyond a structure. `steps` counts rows from the first one.
    fn middle_of_row(&self, side: Face, row: i32, steps: i32) -> Cell {
        let [dx, dy, _] = side.normal();
        let at = row.saturating_add((dx + dy) * steps);
        let [x, y] = self.middle.map(|middle| middle.floor() as i32);
        if dx == 0 {
            Cell::new(x, at, Planar::LAYER)
        } else {
            Cell::new(at, y, Planar::LAYER)
        }
    }

    /// Returns the side of a structure that free blocks come from. It has the most room between the
    /// structure and the wall. If no side has room for a passage of two rows, or if a cell is
    /// outside, walls are ignored.
    pub fn access(self, cells: &[Cell]) -> PlanarAccess {
        let open_side = self.open_side(cells);
        let (side, row) = open_side.unwrap_or_else(|| {
            let top = cells.iter().map(|cell| cell.y).max();
            (Face::North, top.map_or(0, |top| top.saturating_add(1)))
        });
        let endless = PlanarArea {
            half: [f64::INFINITY; 2],
            radius: f64::INFINITY,
            ..self
        };
        PlanarAccess {
            area: if open_side.is_some() { self } else { endless },
            side,
            row,
            ignores_walls: self.has_walls() && open_side.is_none(),
        }
    }

    /// Returns the side with the most room, and its first row. Returns `None` if no side has enough.
    fn open_side(&self, cells: &[Cell]) -> Option<(Face, i32)> {
        if !cells.iter().all(|&cell| self.contains(cell)) {
            return None;
        }
        let (x, y) = (|cell: &Cell| cell.x, |cell: &Cell| cell.y);
        let low = [cells.iter().map(x).min()?, cells.iter().map(y).min()?];
        let high = [cells.iter().map(x).max()?, cells.iter().map(y).max()?];
        let sides = [Face::North, Face::East, Face::South, Face::West].map(|side| {
            let [dx, dy, _] = side.normal();
            let axis = usize::from(dy != 0);
            let sign = dx + dy;
            let edge = if sign > 0 { high[axis] } else { low[axis] };
            let wall = self.half[axis].min(self.radius);
            let room = wall - f64::from(sign) * (f64::from(edge) - self.middle[axis]);
            let row = edge.saturating_add(sign);
            let end = self.middle_of_row(side, row, PASSAGE - 1);
            (room, self.contains(end).then_some((side, row)))
        });
        // The first side of the largest ones.
        let mut widest: Option<(f64, (Face, i32))> = None;
        for (room, side) in sides {
            if let Some(side) = side
                && widest.is_none_or(|(most, _)| room > most)
            {
                widest = Some((room, side));
            }
        }
        widest.map(|(_, side)| side)
    }
}
