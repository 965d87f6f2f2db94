//! How long a face waits for its block.
use stochc_ir::{Cell, Face};

use crate::sites::{MIDDLE, Window, across, place};

/// The mean times that faces wait.
pub trait Waits {
    /// The mean ticks from when a face opens until its block is anchored in `cell`, `way` from its parent, while the cells of
    /// `window` around it are full; the parent is one of them.
    fn mean(&self, cell: Cell, way: Face, window: Window) -> f64;
}

/// Means by the number of walls, measured in the scene `hemisphere` with one open face at a time.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeasuredWaits;

/// Ticks for an open face, beside a wall, in a corner of two, between two, between three, and in a pit or under a roof.
const MEANS: [f64; 6] = [622.0, 564.0, 710.0, 907.0, 1723.0, 15_000.0];

/// A face of the plate, against one in the air.
const PLATE: f64 = 906.0 / 622.0;

impl Waits for MeasuredWaits {
    fn mean(&self, cell: Cell, way: Face, window: Window) -> f64 {
        let is_wall =
            |face: Face| window & 1 << across(face) != 0 || (cell.z == 1 && face == Face::Down);
        let is_side = |face: &Face| *face != way && *face != way.opposite();
        let walls: Vec<Face> = Face::ALL
            .into_iter()
            .filter(is_side)
            .filter(|&face| is_wall(face))
            .collect();
        let kind = match walls[..] {
            _ if is_wall(way) => 5,
            [] | [_] => walls.len(),
            [first, second] if first == second.opposite() => 3,
            [_, _] => 2,
            [_, _, _] => 4,
            _ => 5,
        };
        let on_plate = if cell.z == 1 && way == Face::Up {
            PLATE
        } else {
            1.0
        };
        MEANS[kind] * on_plate
    }
}

/// The cells of a window around a cell.
pub fn cells(cell: Cell, window: Window) -> impl Iterator<Item = Cell> {
    let steps = || -1..=1;
    let all =
        steps().flat_map(move |dz| steps().flat_map(move |dy| steps().map(move |dx| (dx, dy, dz))));
    let full = all.filter(move |&(dx, dy, dz)| {
        let at = place(dx, dy, dz);
        at != MIDDLE && window & 1 << at != 0
    });
    full.map(move |(dx, dy, dz)| crate::grid::shifted(cell, dx, dy, dz))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn walls_make_waits_longer() {
        let cell = Cell::new(0, 0, 5);
        let window = |faces: &[Face]| faces.iter().fold(0, |bits, &face| bits | 1 << across(face));
        let mean = |faces: &[Face]| MeasuredWaits.mean(cell, Face::Up, window(faces));
        let sides = [Face::East, Face::West, Face::North, Face::South];
        assert_eq!(mean(&[]), 622.0);
        assert_eq!(mean(&[Face::Down]), 622.0);
        assert_eq!(mean(&sides[..2]), 907.0);
        assert_eq!(mean(&sides[1..3]), 710.0);
        assert_eq!(mean(&sides[..3]), 1723.0);
        assert_eq!(mean(&sides), 15_000.0);
        assert_eq!(mean(&[Face::Up]), 15_000.0);
        let low = Cell::new(0, 0, 1);
        assert_eq!(MeasuredWaits.mean(low, Face::Up, 0), 906.0);
        assert_eq!(MeasuredWaits.mean(low, Face::East, 0), 564.0);
        assert_eq!(cells(low, window(&sides)).count(), 4);
    }
}
